"""Scripts with which shells complete commands, each made from the tree of commands of the argument parser."""
