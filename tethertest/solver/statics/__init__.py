"""The cable at rest: closed forms, and the chain that a march starts from."""
