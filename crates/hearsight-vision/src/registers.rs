//! Loads and stores of AVX2 registers, which no safe function of the standard library does.

#![expect(unsafe_code, reason = "loads and stores through pointers")]

use std::arch::x86_64::*;

/// Sixteen bytes.
#[target_feature(enable = "avx2")]
#[inline]
pub(crate) fn load_bytes(from: &[u8; 16]) -> __m128i {
    // SAFETY: the array has the sixteen bytes read, and the load needs no alignment.
    unsafe { _mm_loadu_si128(from.as_ptr().cast()) }
}

/// Sixteen words in two registers.
#[target_feature(enable = "avx2")]
#[inline]
pub(crate) fn load_words(from: &[u32; 16]) -> [__m256i; 2] {
    let (near, far) = from.split_at(8);
    // SAFETY: each half has the eight words read, and the loads need no alignment.
    unsafe {
        [
            _mm256_loadu_si256(near.as_ptr().cast()),
            _mm256_loadu_si256(far.as_ptr().cast()),
        ]
    }
}

/// Sixteen words from two registers.
#[target_feature(enable = "avx2")]
#[inline]
pub(crate) fn store_words(to: &mut [u32; 16], from: [__m256i; 2]) {
    let (near, far) = to.split_at_mut(8);
    // SAFETY: each half has room for the eight words written, and the stores need no alignment.
    unsafe {
        _mm256_storeu_si256(near.as_mut_ptr().cast(), from[0]);
        _mm256_storeu_si256(far.as_mut_ptr().cast(), from[1]);
    }
}

/// Sixteen floats in two registers.
#[target_feature(enable = "avx2")]
#[inline]
pub(crate) fn load_floats(from: &[f32; 16]) -> [__m256; 2] {
    let (near, far) = from.split_at(8);
    // SAFETY: each half has the eight floats read, and the loads need no alignment.
    unsafe { [_mm256_loadu_ps(near.as_ptr()), _mm256_loadu_ps(far.as_ptr())] }
}

/// Sixteen floats from two registers.
#[target_feature(enable = "avx2")]
#[inline]
pub(crate) fn store_floats(to: &mut [f32; 16], from: [__m256; 2]) {
    let (near, far) = to.split_at_mut(8);
    // SAFETY: each half has room for the eight floats written, and the stores need no alignment.
    unsafe {
        _mm256_storeu_ps(near.as_mut_ptr(), from[0]);
        _mm256_storeu_ps(far.as_mut_ptr(), from[1]);
    }
}

/// Sixteen doubles from four registers.
#[target_feature(enable = "avx2")]
#[inline]
pub(crate) fn store_doubles(to: &mut [f64; 16], from: [__m256d; 4]) {
    let (quarters, _) = to.as_chunks_mut::<4>();
    for (quarter, from) in quarters.iter_mut().zip(from) {
        // SAFETY: each quarter has room for the four doubles written, and the store needs no alignment.
        unsafe { _mm256_storeu_pd(quarter.as_mut_ptr(), from) };
    }
}
