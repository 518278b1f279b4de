/// Version of this interface. It grows whenever a structure or the meaning of a function changes; compare it with
/// fric_abi_version() once at start-up.
pub const FRIC_ABI_VERSION: u32 = 1;
