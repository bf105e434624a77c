//! How often OpenCV's cascades find rendered people in cluttered rooms, over the angle at which they are seen.
//!
//! ```text
//! cascades [PEOPLE [SEED [DIRECTORY]]]     prints the curves; writes shares.csv, boxes.csv and the first pictures (PPM)
//! ```
//!
//! Every person is seen at one angle, in a room of their own, with a head of 40 pixels or more. Cascades of Debian's
//! package opencv-data; scale step 1.1, more than 4 neighbours (5 for bodies), windows as small as such heads
//! need.

use hearsight_benches::{Failure, curves, sittings};
use std::io::Write;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let people = arguments.first().map_or(Ok(240), |text| text.parse())?;
    let seed = arguments.get(1).map_or(Ok(1), |text| text.parse())?;
    let curves = curves(people, seed)?;
    print!("{curves}");
    println!("narrowest head {:.0} px", curves.narrowest_head_px());
    if let Some(directory) = arguments.get(2) {
        std::fs::write(format!("{directory}/shares.csv"), curves.shares_csv())?;
        std::fs::write(format!("{directory}/boxes.csv"), curves.boxes_csv())?;
        for (number, (sitting, picture)) in sittings(people.min(60), seed).into_iter().enumerate() {
            let (mut rgb, mut luma) = (Vec::new(), Vec::new());
            picture.to_rgb(&mut rgb, &mut luma);
            let name = format!("{directory}/{number:03}_{:+.0}.ppm", sitting.yaw_degrees);
            let mut file = std::fs::File::create(name)?;
            write!(file, "P6\n{} {}\n255\n", picture.width, picture.height)?;
            file.write_all(&rgb)?;
        }
    }
    Ok(())
}
