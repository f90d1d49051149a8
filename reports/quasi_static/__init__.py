"""The quasi-static model's predicted error against its true one."""
