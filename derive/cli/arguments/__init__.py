"""The arguments of each command and their help texts. Only the standard library is imported here."""
