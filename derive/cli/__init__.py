"""The command line `tisserand`: one module per command."""
