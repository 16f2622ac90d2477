"""The cheapest model of a scene that is accurate enough: screening, search, and the specification of the choice."""
