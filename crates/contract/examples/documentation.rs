//! Remakes the documents that are made from the programs: `make documentation`.

use posecut_contract::documentation::pages;

fn main() -> std::io::Result<()> {
    for page in pages() {
        if !page.is_current() {
            page.write()?;
            #[expect(clippy::print_stdout, reason = "this is what the program says")]
            {
                println!("remade {}", page.path.display());
            }
        }
    }
    Ok(())
}
