//! Gives the shared library its name with the ABI version in it, so that a program finds no other.
#![allow(clippy::doc_markdown, reason = "the documentation is for C")]

include!("src/abi.rs");

fn main() {
    println!("cargo:rerun-if-changed=src/abi.rs");
    match std::env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("linux" | "freebsd" | "netbsd" | "openbsd") => {
            println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libfric.so.{FRIC_ABI_VERSION}");
        }
        Ok("macos") => {
            println!("cargo:rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libfric.{FRIC_ABI_VERSION}.dylib");
        }
        _ => {}
    }
}
