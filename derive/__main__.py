"""`python -m derive` is `tisserand`."""

from derive.cli.main import main

raise SystemExit(main())
