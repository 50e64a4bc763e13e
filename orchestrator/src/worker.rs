//! Orders in, replies out: the trait that every placement of instances implements.
