"""The paper's printed equations, and a second derivation of them that shares no code with the package."""
