"""What pages may have done: cases judged, records checked again; with the token where there is one."""
