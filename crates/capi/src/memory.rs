//! Memory of the caller: arrays and texts that are read, places that are written.
//!
//! Every function checks what can be checked: null, alignment, and lengths beyond the address
//! space. Whether a pointer leads to as many elements as the caller states cannot be checked.

use std::ffi::{CStr, CString, c_char};
use std::marker::PhantomData;

use crate::border::{Status, bad_argument, error, lc_status};

/// Returns whether a pointer is neither null nor misaligned.
#[inline(always)]
fn is_sound<T>(pointer: *const T) -> bool {
    !pointer.is_null() && pointer.is_aligned()
}

/// Returns whether `count` elements of `stride` bytes fit into the address space.
#[inline(always)]
fn fits(count: usize, stride: usize) -> bool {
    count
        .checked_mul(stride)
        .is_some_and(|bytes| bytes <= isize::MAX as usize)
}

/// Panics unless an index is less than a count.
#[inline(always)]
fn check_index(index: usize, count: usize) {
    if index >= count {
        beyond(index, count);
    }
}

#[cold]
#[inline(never)]
fn beyond(index: usize, count: usize) -> ! {
    panic!("element {index} of {count}")
}

/// Borrows an array of the caller.
///
/// # Safety
/// `data` is null, or points to `len` elements that nothing writes to during `'a`: no other thread,
/// no callback, and no answer that overlaps them.
#[inline]
pub(crate) unsafe fn array<'a, T>(data: *const T, len: usize, name: &str) -> Result<&'a [T], lc_status> {
    if len == 0 {
        return Ok(&[]);
    }
    if !is_sound(data) || !fits(len, size_of::<T>()) {
        return Err(bad_argument(name));
    }
    // SAFETY: by the caller's contract and the checks above.
    Ok(unsafe { std::slice::from_raw_parts(data, len) })
}

/// Borrows `count` rows of `columns` elements.
///
/// # Safety
/// As [`array()`], for `count * columns` elements.
#[inline]
pub(crate) unsafe fn table<'a, T>(
    data: *const T,
    count: usize,
    columns: usize,
    name: &str,
) -> Result<&'a [T], lc_status> {
    let len = count.checked_mul(columns).ok_or_else(|| bad_argument(name))?;
    // SAFETY: by the caller's contract.
    unsafe { array(data, len, name) }
}

/// Borrows a text of the caller, which must be UTF-8.
///
/// # Safety
/// `text` is null, or points to bytes that end with a zero and that nothing writes to during `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, lc_status> {
    if text.is_null() {
        return Err(bad_argument(name));
    }
    // SAFETY: by the caller's contract.
    let bytes = unsafe { CStr::from_ptr(text) };
    let refuse = |_| error(lc_status::LC_ARGUMENT, &format_args!("argument `{name}` is not UTF-8"));
    bytes.to_str().map_err(refuse)
}

/// Elements of the caller that are read one by one; a stride of zero repeats the first.
#[derive(Clone, Copy)]
pub(crate) struct Given<'a, T> {
    data: *const T,
    stride: usize,
    count: usize,
    borrowed: PhantomData<&'a T>,
}

impl<'a, T: Copy> Given<'a, T> {
    /// # Safety
    /// `data` is null, or points to `count` elements at the stride, in bytes, that live during
    /// `'a`.
    #[inline(always)]
    pub(crate) unsafe fn new(data: *const T, stride: usize, count: usize, name: &str) -> Result<Self, lc_status> {
        let is_stride = stride == 0 || stride >= size_of::<T>() && stride.is_multiple_of(align_of::<T>());
        if count > 0 && !is_sound(data) || !is_stride || !fits(count, stride) {
            return Err(bad_argument(name));
        }
        Ok(Self {
            data,
            stride,
            count,
            borrowed: PhantomData,
        })
    }

    /// # Safety
    /// `data` is null, or points to an element that lives during `'a`.
    #[inline(always)]
    pub(crate) unsafe fn one(data: *const T, name: &str) -> Result<T, lc_status> {
        if !is_sound(data) {
            return Err(bad_argument(name));
        }
        // SAFETY: by the caller's contract.
        Ok(unsafe { *data })
    }

    /// Copies an element, so that an answer may be written over it.
    #[inline(always)]
    pub(crate) fn get(&self, index: usize) -> T {
        check_index(index, self.count);
        // SAFETY: the index is less than the count, so the element lies in the array of the caller.
        let element = unsafe { self.data.byte_add(index * self.stride) };
        // SAFETY: by the contract of `new`.
        unsafe { *element }
    }
}

/// A struct of which callers may know a shorter or a longer version.
///
/// # Safety
/// The type is `repr(C)`, every pattern of bits is a valid value, and the size of its first version
/// is `FIRST`.
pub(crate) unsafe trait Plain: Copy {
    /// Bytes of the first version; no caller knows less.
    const FIRST: usize;
}

/// Places of the caller that are written: answers, at a stride that is the size that the caller
/// knows.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a, T> {
    data: *mut T,
    stride: usize,
    count: usize,
    borrowed: PhantomData<&'a mut T>,
}

impl<T: Plain> Places<'_, T> {
    /// # Safety
    /// `data` is null, or points to `count` writable places at the stride, in bytes.
    #[inline(always)]
    pub(crate) unsafe fn new(data: *mut T, stride: usize, count: usize, name: &str) -> Result<Self, lc_status> {
        const { assert!(T::FIRST <= size_of::<T>()) };
        let is_stride = stride >= T::FIRST && (count < 2 || stride.is_multiple_of(align_of::<T>()));
        if count > 0 && !is_sound(data.cast_const()) || !is_stride || !fits(count, stride) {
            return Err(bad_argument(name));
        }
        Ok(Self {
            data,
            stride,
            count,
            borrowed: PhantomData,
        })
    }

    /// Writes an answer. What a shorter version lacks is left out; what a longer one has more is
    /// zero.
    ///
    /// A target of the usual size gets the fields at once. By way of the stack the copy would read
    /// what stores still on their way hold in other pieces, which stops the processor.
    #[inline(always)]
    pub(crate) fn write(&self, index: usize, answer: T) {
        check_index(index, self.count);
        // SAFETY: the index is less than the count, so the place lies in the array of the caller.
        let place = unsafe { self.data.byte_add(index * self.stride) };
        let mut spare = std::mem::MaybeUninit::<T>::uninit();
        let is_usual = self.stride == size_of::<T>();
        let to = if is_usual { place } else { spare.as_mut_ptr() };
        // SAFETY: by the contract of `new`, or because `spare` is a place.
        unsafe { to.write(answer) };
        if !is_usual {
            // SAFETY: the place has `stride` bytes by the contract of `new`; `spare` was written.
            unsafe { write_part(place, self.stride, spare.as_ptr()) };
        }
    }

    /// Writes as many answers as there are places, and returns how many there are.
    pub(crate) fn fill(&self, answers: impl Iterator<Item = T>) -> usize {
        let mut count = 0;
        for answer in answers {
            if count < self.count {
                self.write(count, answer);
            }
            count += 1;
        }
        count
    }
}

/// # Safety
/// `place` has `size` writable bytes; `answer` points to an answer that is not among them.
#[cold]
#[inline(never)]
unsafe fn write_part<T: Plain>(place: *mut T, size: usize, answer: *const T) {
    let known = size.min(size_of::<T>());
    let (from, to) = (answer.cast::<u8>(), place.cast::<u8>());
    // SAFETY: `known` is at most the size of both, by the caller's contract.
    unsafe { std::ptr::copy_nonoverlapping(from, to, known) };
    // SAFETY: `known` is at most `size`.
    let rest = unsafe { to.add(known) };
    // SAFETY: the bytes from `known` to `size` are writable by the caller's contract.
    unsafe { rest.write_bytes(0, size - known) };
}

/// Reads options, of which the caller may know a shorter or a longer version; null is all zero.
///
/// # Safety
/// `options` is null, or points to `size` bytes.
pub(crate) unsafe fn options<T: Plain>(options: *const T, size: usize, name: &str) -> Result<T, lc_status> {
    const { assert!(T::FIRST <= size_of::<T>()) };
    let mut read = std::mem::MaybeUninit::<T>::zeroed();
    if !options.is_null() {
        if !is_sound(options) || size < T::FIRST || size > isize::MAX as usize {
            return Err(bad_argument(name));
        }
        // SAFETY: by the caller's contract.
        let bytes = unsafe { std::slice::from_raw_parts(options.cast::<u8>(), size) };
        let (known, rest) = bytes.split_at(size.min(size_of::<T>()));
        if rest.iter().any(|&byte| byte != 0) {
            let message = format_args!("argument `{name}` has an option that this version does not know");
            return Err(error(lc_status::LC_ARGUMENT, &message));
        }
        // SAFETY: `known` is at most the size of the options.
        unsafe { std::ptr::copy_nonoverlapping(known.as_ptr(), read.as_mut_ptr().cast::<u8>(), known.len()) };
    }
    // SAFETY: by the contract of `Plain`, every pattern of bits is a value.
    Ok(unsafe { read.assume_init() })
}

/// One location of the caller for a number, a handle or a pointer.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a, T> {
    data: *mut T,
    borrowed: PhantomData<&'a mut T>,
}

impl<T> Place<'_, T> {
    /// # Safety
    /// `data` is null, or points to a writable place.
    #[inline(always)]
    pub(crate) unsafe fn new(data: *mut T, name: &str) -> Result<Self, lc_status> {
        if !is_sound(data.cast_const()) {
            return Err(bad_argument(name));
        }
        Ok(Self {
            data,
            borrowed: PhantomData,
        })
    }

    #[inline(always)]
    pub(crate) fn write(&self, value: T) {
        // SAFETY: by the contract of `new`.
        unsafe { self.data.write(value) };
    }
}

impl Place<'_, *mut c_char> {
    /// Writes a new text, which the caller frees by `lc_text_free`.
    pub(crate) fn write_text(&self, text: impl ToString) -> Status {
        let mut bytes = text.to_string().into_bytes();
        bytes.retain(|&byte| byte != 0);
        let text = CString::new(bytes).map_err(|e| error(lc_status::LC_REFUSED, &e))?;
        self.write(text.into_raw());
        Ok(())
    }
}

/// An array of the caller that is written: numbers, one row after another.
///
/// # Safety
/// `data` is null, or points to `len` writable places that nothing reads during `'a`.
pub(crate) unsafe fn written<'a, T: Copy>(data: *mut T, len: usize, name: &str) -> Result<Numbers<'a, T>, lc_status> {
    if len > 0 && !is_sound(data.cast_const()) || !fits(len, size_of::<T>()) {
        return Err(bad_argument(name));
    }
    Ok(Numbers {
        data,
        len,
        borrowed: PhantomData,
    })
}

/// See [`written`].
#[derive(Clone, Copy)]
pub(crate) struct Numbers<'a, T> {
    data: *mut T,
    len: usize,
    borrowed: PhantomData<&'a mut T>,
}

impl<T: Copy> Numbers<'_, T> {
    pub(crate) fn write(&self, index: usize, value: T) {
        check_index(index, self.len);
        // SAFETY: the index is less than the length.
        let place = unsafe { self.data.add(index) };
        // SAFETY: by the contract of `written`; the memory may be uninitialised, and is not read.
        unsafe { place.write(value) };
    }

    /// Writes as many values as there are places, and returns how many values there are.
    pub(crate) fn fill(&self, values: impl Iterator<Item = T>) -> usize {
        let mut count = 0;
        for value in values {
            if count < self.len {
                self.write(count, value);
            }
            count += 1;
        }
        count
    }
}
