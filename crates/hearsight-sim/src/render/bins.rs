//! Which triangles touch which rows of the picture.

use super::figure::Figure;

/// Rows that are drawn together. Even, since two rows share their chroma.
pub(super) const BAND_ROWS: usize = 16;

/// A triangle of a person, shifted by so many turns of a panorama.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entry {
    pub(super) person: u32,
    pub(super) facet: u32,
    pub(super) turns: i8,
}

/// Triangles by bands of rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Bins {
    all: Vec<(u32, u32, Entry)>,
    starts: Vec<usize>,
    entries: Vec<Entry>,
}

impl Bins {
    /// Sorts the triangles of everyone (`people` are places in `figures`) into bands of a picture; `turn` is a
    /// panorama's columns a turn.
    pub(super) fn fill(
        &mut self,
        figures: &[Figure],
        people: &[usize],
        width: usize,
        height: usize,
        turn: Option<f32>,
    ) {
        let bands = height.div_ceil(BAND_ROWS);
        self.all.clear();
        let shifts: &[i8] = if turn.is_some() { &[-1, 0, 1] } else { &[0] };
        for (person, place) in people.iter().enumerate() {
            let figure = &figures[*place];
            if !figure.drawn {
                continue;
            }
            for (facet, shape) in figure.facets().iter().enumerate() {
                let [a, b, c] = shape.corners.map(|corner| &figure.seen[corner as usize]);
                let area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
                // Not a number where a corner is not seen.
                if !(area > 0.0 || (shape.thin && area < 0.0)) {
                    continue;
                }
                let reach = |seen: &super::figure::Seen| 0.5 * seen.dv.abs() + 0.5;
                let top = (a.v - reach(a)).min(b.v - reach(b)).min(c.v - reach(c));
                let bottom = (a.v + reach(a)).max(b.v + reach(b)).max(c.v + reach(c));
                if bottom < 0.0 || top > height as f32 - 1.0 {
                    continue;
                }
                let reach = |seen: &super::figure::Seen| 0.5 * seen.du.abs() + 0.5;
                let left = (a.u - reach(a)).min(b.u - reach(b)).min(c.u - reach(c));
                let right = (a.u + reach(a)).max(b.u + reach(b)).max(c.u + reach(c));
                let first = top.max(0.0) as usize / BAND_ROWS;
                let last = (bottom.min(height as f32 - 1.0) as usize / BAND_ROWS).min(bands - 1);
                for turns in shifts {
                    let shift = f32::from(*turns) * turn.unwrap_or(0.0);
                    if right + shift >= 0.0 && left + shift <= width as f32 - 1.0 {
                        let entry = Entry {
                            person: person as u32,
                            facet: facet as u32,
                            turns: *turns,
                        };
                        self.all.push((first as u32, last as u32, entry));
                    }
                }
            }
        }
        self.starts.clear();
        self.starts.resize(bands + 1, 0);
        for (first, last, _) in &self.all {
            for band in *first..=*last {
                self.starts[band as usize + 1] += 1;
            }
        }
        for band in 0..bands {
            self.starts[band + 1] += self.starts[band];
        }
        self.entries.clear();
        self.entries.resize(self.starts[bands], Entry::default());
        // Filled from the front; what each band's start has become is the next one's, so it is set back afterwards.
        for (first, last, entry) in &self.all {
            for band in *first..=*last {
                self.entries[self.starts[band as usize]] = *entry;
                self.starts[band as usize] += 1;
            }
        }
        self.starts.rotate_right(1);
        if let Some(first) = self.starts.first_mut() {
            *first = 0;
        }
        if let Some(last) = self.starts.last_mut() {
            *last = self.entries.len();
        }
    }

    /// The triangles of a band, in the order of people.
    pub(super) fn band(&self, band: usize) -> &[Entry] {
        match (self.starts.get(band), self.starts.get(band + 1)) {
            (Some(from), Some(to)) => &self.entries[*from..*to],
            _ => &[],
        }
    }
}
