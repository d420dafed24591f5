"""The console in the browser: the only package that knows viser, and the web server in front of it."""
