"""The commands of `tisserand`, a module each: `run(options)` returns the exit code."""
