"""The cost of accuracy: a ladder of models of one scene, their errors against a reference, and their cost."""
