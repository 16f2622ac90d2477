"""The code of loops over the members of classes and groups, and the data that all functions of a mechanism share."""
