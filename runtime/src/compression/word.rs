//! A word on the link.

/// Up to 64 bits, sent together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    value: u64,
    bits: u32,
}

impl Word {
    /// The `bits` (1 to 64) low bits of `value`; higher ones are cut off. `None` for another number of
    /// bits.
    pub const fn new(value: u64, bits: u32) -> Option<Self> {
        match bits {
            1..=63 => Some(Self {
                value: value & ((1 << bits) - 1),
                bits,
            }),
            64 => Some(Self { value, bits }),
            _ => None,
        }
    }

    /// A word whose length is known to be in 1..=64: the caller has checked it.
    pub(super) const fn of(value: u64, bits: u32) -> Self {
        match Self::new(value, bits) {
            Some(word) => word,
            None => Self { value, bits: 64 },
        }
    }

    /// The bits as an unsigned number, most significant bit first on the link.
    pub const fn value(&self) -> u64 {
        self.value
    }

    /// Number of bits, 1 to 64.
    pub const fn bits(&self) -> u32 {
        self.bits
    }

    /// The word with one bit inverted, counted from zero at the least significant one; the same word
    /// when it has no such bit.
    pub const fn with_flipped(&self, bit: u32) -> Self {
        if bit >= self.bits {
            return *self;
        }
        Self {
            value: self.value ^ (1 << bit),
            bits: self.bits,
        }
    }
}
