"""The intermediate representation: expressions, statements, sparsity patterns, models, and an interpreter."""
