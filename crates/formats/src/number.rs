//! Numbers of binary files.

/// The types of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    Little,
    Big,
}

impl Type {
    /// Returns the type of a letter, `f`, `i` or `u`, and a number of bytes.
    pub(crate) fn of(letter: u8, bytes: u64) -> Option<Self> {
        Some(match (letter, bytes) {
            (b'i', 1) => Self::I8,
            (b'u', 1) => Self::U8,
            (b'i', 2) => Self::I16,
            (b'u', 2) => Self::U16,
            (b'i', 4) => Self::I32,
            (b'u', 4) => Self::U32,
            (b'i', 8) => Self::I64,
            (b'u', 8) => Self::U64,
            (b'f', 4) => Self::F32,
            (b'f', 8) => Self::F64,
            _ => return None,
        })
    }

    pub(crate) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Takes a number from the start of the bytes; `None` if they are too few. An integer of 64 bits
    /// beyond 2^53 is rounded.
    pub(crate) fn take(self, bytes: &mut &[u8], order: Order) -> Option<f64> {
        fn first<const N: usize>(bytes: &mut &[u8], order: Order) -> Option<[u8; N]> {
            let (first, rest) = bytes.split_first_chunk::<N>()?;
            *bytes = rest;
            let mut number = *first;
            if order == Order::Big {
                number.reverse();
            }
            Some(number)
        }
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes(first(bytes, order)?)),
            Self::U8 => f64::from(u8::from_le_bytes(first(bytes, order)?)),
            Self::I16 => f64::from(i16::from_le_bytes(first(bytes, order)?)),
            Self::U16 => f64::from(u16::from_le_bytes(first(bytes, order)?)),
            Self::I32 => f64::from(i32::from_le_bytes(first(bytes, order)?)),
            Self::U32 => f64::from(u32::from_le_bytes(first(bytes, order)?)),
            Self::I64 => i64::from_le_bytes(first(bytes, order)?) as f64,
            Self::U64 => u64::from_le_bytes(first(bytes, order)?) as f64,
            Self::F32 => f64::from(f32::from_le_bytes(first(bytes, order)?)),
            Self::F64 => f64::from_le_bytes(first(bytes, order)?),
        })
    }
}
