"""Reading specifications: TOML, validation, error locations and the JSON schema."""
