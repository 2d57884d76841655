"""The smallest change that turns a verdict, where nobody names one."""
