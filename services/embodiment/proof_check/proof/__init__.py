"""A proof as data: what it claims, the trees that it holds, its bytes."""
