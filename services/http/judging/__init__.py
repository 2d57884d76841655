"""Cases judged in processes that can be killed at their deadline."""
