"""`python -m derive` is `tisserand`."""

from derive.cli import main

raise SystemExit(main())
