//! A word on the link, and words of any length packed without gaps into bytes.

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

/// Writes words into bytes, the most significant bit first.
#[derive(Debug)]
pub struct BitWriter<'a> {
    bytes: &'a mut [u8],
    bits: usize,
}

impl<'a> BitWriter<'a> {
    /// A writer that begins at the first bit of `bytes`, whose content is overwritten.
    pub fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, bits: 0 }
    }

    /// Bits written so far.
    pub fn bits(&self) -> usize {
        self.bits
    }

    /// Appends a word. False, and nothing is written, when it does not fit.
    pub fn write(&mut self, word: &Word) -> bool {
        let length = word.bits() as usize;
        let room = self.bytes.len().saturating_mul(8);
        if room.saturating_sub(self.bits) < length {
            return false;
        }
        for index in (0..word.bits()).rev() {
            let set = word.value().checked_shr(index).unwrap_or(0) & 1 == 1;
            if let Some(byte) = self.bytes.get_mut(self.bits / 8) {
                let mask = 0x80_u8 >> (self.bits % 8);
                *byte = if set { *byte | mask } else { *byte & !mask };
            }
            self.bits += 1;
        }
        true
    }
}

/// Reads words from bytes, the most significant bit first.
#[derive(Clone, Debug)]
pub struct BitReader<'a> {
    bytes: &'a [u8],
    bits: usize,
}

impl<'a> BitReader<'a> {
    /// A reader that begins at the first bit of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, bits: 0 }
    }

    /// The next word of `bits` bits (1 to 64); `None`, and nothing is read, when there are not so many
    /// left.
    pub fn read(&mut self, bits: u32) -> Option<Word> {
        let room = self.bytes.len().saturating_mul(8);
        if !(1..=64).contains(&bits) || room.saturating_sub(self.bits) < bits as usize {
            return None;
        }
        let mut value = 0_u64;
        for _ in 0..bits {
            let byte = self.bytes.get(self.bits / 8)?;
            let set = byte & (0x80_u8 >> (self.bits % 8)) != 0;
            value = (value << 1) | u64::from(set);
            self.bits += 1;
        }
        Word::new(value, bits)
    }
}
