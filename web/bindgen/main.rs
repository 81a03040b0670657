//! What wasm-bindgen's own program does, without what that needs to run tests and to download:
//! `bindgen MODULE FOLDER` writes the JavaScript of a module for a page.

use std::env::args;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let module = args().nth(1).ok_or("a module is missing")?;
    let folder = args().nth(2).ok_or("a folder is missing")?;
    let mut bindgen = wasm_bindgen_cli_support::Bindgen::new();
    bindgen.input_path(module).typescript(false).web(true)?;
    Ok(bindgen.generate(folder)?)
}
