"""What accuracy costs: a ladder of models of one scene, their errors against a reference, and their cost."""
