"""Trees of boxes of joint positions, found by compiled branch and bound; nothing here is trusted."""
