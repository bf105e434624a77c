//! The picture without people, learnt as it comes, and the mask of what differs from it.
//!
//! Each pixel follows an approximated median (McFarlane and Schofield 1995): its estimate moves towards the picture by
//! a fixed number of grey levels a second, so what passes by hardly counts, and far slower where a person is seen. The
//! first pictures give their true median. A change of exposure is taken out by the median ratio of picture and
//! background; shadows and highlights are what has the background's colour at another brightness (Horprasert, Harwood
//! and Davis 1999). Where a person stood in the first pictures and left, a ghost remains: see [`ghosts`].

pub mod ghosts;
mod light;
mod options;
mod state;

pub use options::BackgroundOptions;
pub use state::BackgroundState;

use crate::VisionError;
use crate::bits::pack_row;
use crate::change::flag_row;
use crate::mask::MaskCleaner;
use ghosts::GhostFinder;
use hearsight_core::{Mask, RgbView, Span};

/// What a step noticed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackgroundReport {
    /// Brightness of the picture over that of the background, red, green and blue; 1 where the light is as learnt.
    pub gain: [f32; 3],
    /// Ghosts taken into the background in this step.
    pub ghosts: usize,
    /// Whether the first pictures are still being gathered; masks are then provisional.
    pub learning: bool,
}

/// Learns a background and finds what differs from it: the saved state and the buffers to step it.
#[derive(Clone, Debug)]
pub struct BackgroundModel {
    options: BackgroundOptions,
    state: BackgroundState,
    cleaner: MaskCleaner,
    ghosts: GhostFinder,
    expected: Vec<u8>,
    flags: Vec<u8>,
    ratios: Vec<[u32; 3]>,
    raw: Mask,
}

impl BackgroundModel {
    /// A model that has seen nothing.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range.
    pub fn new(options: BackgroundOptions) -> Result<Self, VisionError> {
        Self::restore(options, BackgroundState::default())
    }

    /// A model that goes on from a saved state.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range or the state's lengths contradict each other.
    pub fn restore(options: BackgroundOptions, state: BackgroundState) -> Result<Self, VisionError> {
        options.validate()?;
        state.validate()?;
        Ok(Self {
            cleaner: MaskCleaner::new(options.clean)?,
            options,
            state,
            ghosts: GhostFinder::default(),
            expected: Vec::new(),
            flags: Vec::new(),
            ratios: Vec::new(),
            raw: Mask::default(),
        })
    }

    /// The options.
    pub fn options(&self) -> &BackgroundOptions {
        &self.options
    }

    /// What is to be saved.
    pub fn state(&self) -> &BackgroundState {
        &self.state
    }

    /// Writes into `mask` where `picture` differs from the background, then learns from it. `elapsed` is the time since
    /// the picture before (for the first one it does not matter; negative counts as zero).
    ///
    /// # Errors
    /// [`VisionError::Size`] where the picture's size is not that of the pictures before; nothing is changed then.
    pub fn step(
        &mut self,
        picture: RgbView<'_>,
        elapsed: Span,
        mask: &mut Mask,
    ) -> Result<BackgroundReport, VisionError> {
        let seconds = elapsed.seconds().clamp(0.0, 60.0) as f32;
        if self.state.is_empty() {
            self.state.begin(picture);
        } else {
            VisionError::same_size(self.state.size(), (picture.width, picture.height))?;
            self.state.gather(picture, seconds, &self.options);
        }
        let gain = light::gain(picture, &self.state, self.options.largest_gain, &mut self.ratios);
        self.state.expect(gain, &mut self.expected);
        self.compare(picture, mask);
        let ghosts = self.ghosts.step(
            &mut self.state,
            picture,
            &self.expected,
            &self.raw,
            gain,
            seconds,
            &self.options,
        );
        let learning = self.state.is_learning(&self.options);
        if !learning {
            self.state.follow(picture, mask, gain, seconds, &self.options);
        }
        Ok(BackgroundReport {
            gain,
            ghosts,
            learning,
        })
    }

    /// The background under the present light, three bytes a pixel, as of the last step; empty before.
    pub fn expected(&self) -> &[u8] {
        &self.expected
    }

    /// The mask of the last step before dilation.
    pub fn tight_mask(&self) -> &Mask {
        &self.raw
    }

    fn compare(&mut self, picture: RgbView<'_>, mask: &mut Mask) {
        let (width, height) = (picture.width, picture.height);
        self.flags.resize(width, 0);
        let bits = self.cleaner.bits_mut();
        bits.resize(width, height);
        for y in 0..height {
            let expected = &self.expected[y * width * 3..(y + 1) * width * 3];
            flag_row(picture.row(y), expected, self.options.threshold, &mut self.flags);
            light::clear_shadows(picture.row(y), expected, &self.options, &mut self.flags);
            pack_row(&self.flags, bits.row_mut(y));
        }
        self.cleaner.median_bits();
        self.cleaner.write(&mut self.raw);
        self.cleaner.dilate_bits();
        self.cleaner.write(mask);
    }
}

#[cfg(test)]
mod tests;
