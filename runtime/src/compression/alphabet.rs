//! The z-ary words of Yang et al. 2025, (22).

use super::word::Word;
use crate::error::{AllowedRange, Field, ParameterError};

/// Most words of an alphabet, z^m: 2^24. Its words are shorter than a resynchronisation word, from
/// which they differ by their length.
pub const MOST_WORDS: u32 = 1 << 24;

/// Words of m digits in base z, the most significant digit first. Half of them mean a step up, half
/// of them a step down: word h is a step up of level h, word h + z^m / 2 a step down of level h. As z
/// is even, the first digit alone tells the direction: below z/2 is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Alphabet {
    radix: u32,
    digits: u32,
    words: u32,
}

impl Alphabet {
    /// The alphabet of the radix z, even and at least 2, and m digits, at least 1, with z^m at most
    /// [`MOST_WORDS`].
    ///
    /// # Errors
    /// Numbers that are not so.
    pub fn new(radix: u32, digits: u32) -> Result<Self, ParameterError> {
        let most = f64::from(MOST_WORDS);
        AllowedRange::closed(2.0, most).check_scalar("radix", f64::from(radix))?;
        if radix % 2 != 0 {
            return Err(ParameterError::NotEven {
                field: Field::scalar("radix"),
                value: radix,
            });
        }
        let longest = libm::floor(libm::log2(most) / libm::log2(f64::from(radix)) + 1e-9);
        AllowedRange::closed(1.0, longest).check_scalar("digits", f64::from(digits))?;
        Ok(Self {
            radix,
            digits,
            words: radix.saturating_pow(digits),
        })
    }

    /// z.
    pub const fn radix(&self) -> u32 {
        self.radix
    }

    /// m.
    pub const fn digits(&self) -> u32 {
        self.digits
    }

    /// Number of words, z^m.
    pub const fn words(&self) -> u32 {
        self.words
    }

    /// Number of levels that a word can name, z^m / 2.
    pub const fn levels(&self) -> u32 {
        self.words / 2
    }

    /// Bits of a word on a binary link: m log2 z, rounded up.
    pub const fn bits(&self) -> u32 {
        u32::BITS - (self.words - 1).leading_zeros()
    }

    /// The word of a step; `None` for a level the alphabet does not have.
    pub fn word(&self, level: u32, down: bool) -> Option<Word> {
        if level >= self.levels() {
            return None;
        }
        let value = if down { level + self.levels() } else { level };
        Some(Word::of(u64::from(value), self.bits()))
    }

    /// The level of a step and whether it goes down; `None` when the word has another length or is not
    /// one of the alphabet.
    pub fn step(&self, word: &Word) -> Option<(u32, bool)> {
        let value = u32::try_from(word.value()).ok()?;
        if word.bits() != self.bits() || value >= self.words {
            return None;
        }
        let down = value >= self.levels();
        let level = if down { value - self.levels() } else { value };
        Some((level, down))
    }

    /// Digit of a word, below z, counted from zero at the most significant one; `None` when there is
    /// no such digit or the word is not one of the alphabet.
    pub fn digit(&self, word: &Word, index: u32) -> Option<u32> {
        self.step(word)?;
        let value = u32::try_from(word.value()).ok()?;
        let behind = self.digits.checked_sub(index)?.checked_sub(1)?;
        let weight = self.radix.checked_pow(behind)?;
        value.checked_div(weight)?.checked_rem(self.radix)
    }

    /// The word of m digits, the most significant first; `None` when their number is not m or one of
    /// them is not below z.
    pub fn from_digits(&self, digits: &[u32]) -> Option<Word> {
        if u32::try_from(digits.len()) != Ok(self.digits) {
            return None;
        }
        let mut value = 0_u32;
        for digit in digits {
            if *digit >= self.radix {
                return None;
            }
            value = value.checked_mul(self.radix)?.checked_add(*digit)?;
        }
        Some(Word::of(u64::from(value), self.bits()))
    }
}
