"""The playground: teach, push and watch in the browser."""
