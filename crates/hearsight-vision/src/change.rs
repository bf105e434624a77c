//! Colour change between two pictures: |difference| a channel against a threshold, united over channels, cleaned.

use crate::VisionError;
use crate::bits::pack_row;
use crate::mask::{CleanOptions, MaskCleaner};
use hearsight_core::{Mask, RgbView};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// What counts as change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChangeOptions {
    /// A pixel has changed where any channel differs by more than this, grey levels 0 to 255, default 20. Raising it
    /// hides camera noise, and people dressed like the wall.
    pub threshold: u8,
    /// How the mask is cleaned.
    pub clean: CleanOptions,
}

impl Default for ChangeOptions {
    fn default() -> Self {
        Self {
            threshold: 20,
            clean: CleanOptions::default(),
        }
    }
}

/// Finds where two colour pictures differ (Bregonzio et al., section 3.2).
#[derive(Clone, Debug)]
pub struct ChangeDetector {
    threshold: u8,
    cleaner: MaskCleaner,
    flags: Vec<u8>,
}

impl ChangeDetector {
    /// A detector with these options.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where a size is outside its range.
    pub fn new(options: ChangeOptions) -> Result<Self, VisionError> {
        Ok(Self {
            threshold: options.threshold,
            cleaner: MaskCleaner::new(options.clean)?,
            flags: Vec::new(),
        })
    }

    /// Writes into `mask` where `picture` differs from `reference`: threshold, median, dilation.
    ///
    /// # Errors
    /// [`VisionError::Size`] where the pictures differ in size; `mask` is then unchanged.
    pub fn detect(
        &mut self,
        picture: RgbView<'_>,
        reference: RgbView<'_>,
        mask: &mut Mask,
    ) -> Result<(), VisionError> {
        let size = (reference.width, reference.height);
        VisionError::same_size(size, (picture.width, picture.height))?;
        self.flags.resize(picture.width, 0);
        let bits = self.cleaner.bits_mut();
        bits.resize(picture.width, picture.height);
        for y in 0..picture.height {
            flag_row(picture.row(y), reference.row(y), self.threshold, &mut self.flags);
            pack_row(&self.flags, bits.row_mut(y));
        }
        self.cleaner.median_bits();
        self.cleaner.dilate_bits();
        self.cleaner.write(mask);
        Ok(())
    }
}

/// 255 for each pixel of which any channel differs by more than `threshold`, else 0.
#[multiversion(targets("x86_64+avx2", "x86_64+sse4.1"))]
pub(crate) fn flag_row(picture: &[u8], reference: &[u8], threshold: u8, flags: &mut [u8]) {
    let (picture, _) = picture.as_chunks::<3>();
    let (reference, _) = reference.as_chunks::<3>();
    for ((a, b), flag) in picture.iter().zip(reference).zip(flags) {
        let largest = a[0]
            .abs_diff(b[0])
            .max(a[1].abs_diff(b[1]))
            .max(a[2].abs_diff(b[2]));
        *flag = if largest > threshold { 255 } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_more_than_the_threshold_is_change() {
        let clean = CleanOptions {
            median: 1,
            dilation_width: 1,
            dilation_height: 1,
        };
        let mut detector = ChangeDetector::new(ChangeOptions { threshold: 20, clean }).unwrap();
        let reference = [100_u8; 9];
        let picture = [100, 100, 120, 100, 79, 100, 121, 100, 100];
        let mut mask = Mask::default();
        let view = |data| RgbView::new(3, 1, data).unwrap();
        detector
            .detect(view(&picture), view(&reference), &mut mask)
            .unwrap();
        assert_eq!(mask.data, [0, 255, 255]);
        let other = RgbView::new(1, 3, &reference).unwrap();
        assert!(detector.detect(view(&picture), other, &mut mask).is_err());
    }
}
