//! The machine that runs programs. See [`crate::op`] for its operations.
//!
//! Subroutines return through a list of its own rather than the thread's stack, so recursion is bounded by [`DEPTH`]
//! and not by the size of the stack.

use crate::builtin::Builtin;
use crate::error::{Fault, Flag, Warning};
use crate::fractal::fnoise3;
use crate::noise::{noise3, noise3x, noise3y, noise3z};
use crate::op::Op;
use crate::panel;
use crate::program::Program;
use crate::scratch::{DONE, Inputs, Pass, Remembered, Return, Scratch, Slot, State, UNSET};
use crate::source;
use crate::special::rand;

/// Subroutines within each other; Radiance's own stack ends between ten and fifty thousand.
const DEPTH: usize = 1 << 17;

/// Runs a program.
pub(crate) fn run(program: &Program, given: &[f64], pass: &mut Pass<'_>) -> Result<f64, Fault> {
    let Pass { scratch, inputs, constant } = pass;
    let (inputs, constant) = (*inputs, *constant);
    let Scratch { stack: memory, state: s } = &mut **scratch;
    let code = &program.code[..];
    s.slots.clear();
    s.returns.clear();
    if s.variables.len() < program.variables as usize {
        s.variables.resize(program.variables as usize, Remembered::default());
    }
    let mut stack = memory.as_mut_slice();
    let mut top = 0_usize;
    let mut at = 0_usize;
    let mut frame = 0_usize;
    let mut acc = 0.0_f64;
    macro_rules! load {
        ($value:expr) => {{
            let value = $value;
            if let Some(place) = stack.get_mut(top) {
                *place = acc;
            } else {
                stack = grow(memory);
                stack[top] = acc;
            }
            top += 1;
            acc = value;
        }};
    }
    // Every operation that pops follows its loads, so the stack is never empty.
    macro_rules! pop {
        () => {{
            top = top.wrapping_sub(1);
            stack.get(top).copied().unwrap_or(0.0)
        }};
    }
    macro_rules! channel {
        ($index:expr) => {
            match inputs.channels.get($index as usize) {
                Some(value) => *value,
                None => return Err(Fault::NoRay),
            }
        };
    }
    loop {
        let op = &code[at];
        at += 1;
        match *op {
            Op::Number(value) => load!(value),
            Op::Channel(index) => load!(channel!(index)),
            Op::Column(index) => load!(inputs.channels.get(index as usize).copied().unwrap_or(0.0)),
            Op::Given(index) => load!(given.get(index as usize).copied().unwrap_or(0.0)),
            Op::Real { index, slot } => {
                let variable = &mut s.variables[slot as usize];
                if variable.stamp != s.clock {
                    variable.stamp = s.clock;
                    s.flag = Flag::Clear;
                }
                load!(real(inputs.reals, f64::from(index), constant)?);
            }
            Op::Argument(slot) => {
                let index = frame + slot as usize;
                let Slot { code, frame: home, value } = s.slots[index];
                if code == DONE {
                    load!(value);
                } else {
                    enter(s, at, frame, index)?;
                    (at, frame) = (code as usize, home as usize);
                }
            }
            Op::Lazy { slot, label } => {
                let index = frame + slot as usize;
                let kept = s.slots[index];
                if kept.code == DONE {
                    load!(kept.value);
                } else {
                    enter(s, at, frame, index)?;
                    at = label as usize;
                }
            }
            Op::Kept(slot) => load!(s.slots[frame + slot as usize].value),
            Op::Keep(slot) => s.slots[frame + slot as usize].value = acc,
            Op::Variable { slot, label } => {
                let variable = &mut s.variables[slot as usize];
                if variable.stamp == s.clock {
                    load!(variable.value);
                } else {
                    // Stamped before it is computed: a variable that refers to itself finds a value.
                    variable.stamp = s.clock;
                    if !s.history {
                        variable.value = 0.0;
                    }
                    enter(s, at, frame, 0)?;
                    at = label as usize;
                    frame = s.slots.len();
                }
            }

            Op::Add => acc += pop!(),
            Op::Subtract => acc = pop!() - acc,
            Op::Multiply => acc *= pop!(),
            Op::Divide => acc /= pop!(),
            Op::Guard(label) => {
                if acc == 0.0 {
                    s.warn(Warning::DivisionByZero);
                    s.flag = Flag::Range;
                    acc = 0.0;
                    at = label as usize;
                }
            }
            Op::Negate => acc = -acc,
            Op::AddNumber(value) => acc += value,
            Op::MultiplyNumber(value) => acc *= value,
            Op::DivideNumber(value) => acc /= value,
            Op::AddKept(slot) => acc += s.slots[frame + slot as usize].value,
            Op::SubtractKept(slot) => acc -= s.slots[frame + slot as usize].value,
            Op::MultiplyKept(slot) => acc *= s.slots[frame + slot as usize].value,
            Op::ChannelPlus(index, value) => load!(channel!(index) + value),
            Op::ChannelTimes(index, value) => load!(channel!(index) * value),
            Op::ChannelMinusChannel(index, other) => load!(channel!(index) - channel!(other)),
            Op::ChannelTimesChannel(index, other) => load!(channel!(index) * channel!(other)),
            Op::AddChannel(index) => acc += channel!(index),
            Op::SubtractChannel(index) => acc -= channel!(index),
            Op::MultiplyChannel(index) => acc *= channel!(index),
            Op::Power { clear } => {
                let exponent = pop!();
                acc = power(s, acc.powf(exponent), clear);
            }
            Op::PowerNumber(exponent) => acc = power(s, acc.powf(exponent), true),
            Op::Square => acc = power(s, acc * acc, true),

            Op::Clear => s.flag = Flag::Clear,
            Op::Unary { function, clear } => {
                let value = match function {
                    Builtin::Floor => acc.floor(),
                    Builtin::Sqrt => acc.sqrt(),
                    _ => unary(function, acc, &inputs, constant)?,
                };
                acc = finish(s, function, value, clear);
            }
            Op::Native { function, clear } => {
                let value = match function {
                    Builtin::Atan2 => acc.atan2(pop!()),
                    Builtin::SourceCorr => source::correction(ray(inputs.channels)?, inputs.reals, pop!(), acc)?,
                    Builtin::PrismValue => {
                        let side = pop!();
                        panel::value(&mut s.panel, ray(inputs.channels)?, inputs.reals, [pop!(), side, acc])?
                    }
                    _ => {
                        let y = pop!();
                        ternary(function, [pop!(), y, acc])?
                    }
                };
                acc = finish(s, function, value, clear);
            }
            Op::Extreme { max, count, clear } => {
                for _ in 1..count {
                    let other = pop!();
                    acc = if max { other.max(acc) } else { other.min(acc) };
                }
                acc = finish(s, if max { Builtin::Max } else { Builtin::Min }, acc, clear);
            }
            Op::Unless { label, clear } => {
                if clear {
                    s.flag = Flag::Clear;
                }
                let positive = acc > 0.0;
                if !positive {
                    at = label as usize;
                }
                acc = pop!();
            }
            Op::Select { count, end } => match selected(acc, count) {
                Some(0) => (acc, at) = (f64::from(count), end as usize),
                Some(k) => {
                    at += k as usize - 1;
                    acc = pop!();
                }
                None => {
                    s.flag = Flag::Domain;
                    (acc, at) = (0.0, end as usize);
                }
            },
            Op::Jump(address) => at = address as usize,
            Op::Finish(function) => acc = finish(s, function, acc, false),

            Op::PassNumber(value) => s.slots.push(Slot { code: DONE, frame: 0, value }),
            Op::PassLater(label) => s.slots.push(Slot { code: label, frame: frame as u32, value: 0.0 }),
            Op::Call { label, count } => {
                enter(s, at, frame, 0)?;
                at = label as usize;
                frame = s.slots.len() - count as usize;
            }
            Op::Enter(slots) => s.slots.resize(frame + slots as usize, UNSET),
            Op::Return | Op::ReturnVariable(_) => {
                if let Op::ReturnVariable(slot) = *op {
                    s.variables[slot as usize].value = acc;
                }
                s.slots.truncate(frame);
                let Return { address, frame: caller, .. } = s.returns.pop().unwrap_or(START);
                (at, frame) = (address as usize, caller as usize);
            }
            Op::ReturnKeep => {
                let Return { address, frame: caller, slot } = s.returns.pop().unwrap_or(START);
                s.slots[slot as usize] = Slot { code: DONE, frame: 0, value: acc };
                (at, frame) = (address as usize, caller as usize);
            }
            Op::Halt => return Ok(acc),
            Op::Fault(index) => return Err(program.faults[index as usize].clone()),
        }
    }
}

/// Where a return without a call would go; code never does that.
const START: Return = Return { address: 0, frame: 0, slot: 0 };

/// Library functions of one argument.
#[inline(never)]
fn unary(function: Builtin, x: f64, inputs: &Inputs<'_>, constant: bool) -> Result<f64, Fault> {
    Ok(match function {
        Builtin::Ceil => x.ceil(),
        Builtin::Exp => x.exp(),
        Builtin::Log => x.ln(),
        Builtin::Log10 => x.log10(),
        Builtin::Sin => x.sin(),
        Builtin::Cos => x.cos(),
        Builtin::Tan => x.tan(),
        Builtin::Asin => x.asin(),
        Builtin::Acos => x.acos(),
        Builtin::Atan => x.atan(),
        Builtin::Rand => rand(x),
        Builtin::Erf => libm::erf(x),
        Builtin::Erfc => libm::erfc(x),
        Builtin::Arg => real(inputs.reals, x, constant)?,
        Builtin::In => column(inputs.channels, x),
        Builtin::SourceTheta => source::theta(ray(inputs.channels)?),
        Builtin::SourcePhi => source::phi(ray(inputs.channels)?, x)?,
        _ => return Err(Fault::Unsupported(function.name())),
    })
}

/// Library functions of a point.
#[inline(never)]
fn ternary(function: Builtin, [x, y, z]: [f64; 3]) -> Result<f64, Fault> {
    Ok(match function {
        Builtin::Noise3 => noise3(x, y, z),
        Builtin::Noise3x => noise3x(x, y, z),
        Builtin::Noise3y => noise3y(x, y, z),
        Builtin::Noise3z => noise3z(x, y, z),
        Builtin::Fnoise3 => fnoise3(x, y, z),
        _ => return Err(Fault::Unsupported(function.name())),
    })
}

/// Makes the stack twice as high.
#[cold]
fn grow(memory: &mut Vec<f64>) -> &mut [f64] {
    memory.resize((2 * memory.len()).max(64), 0.0);
    memory
}

#[inline]
fn enter(s: &mut State, at: usize, frame: usize, slot: usize) -> Result<(), Fault> {
    if s.returns.len() >= DEPTH {
        return Err(Fault::TooDeep);
    }
    s.returns.push(Return { address: at as u32, frame: frame as u32, slot: slot as u32 });
    Ok(())
}

/// The end of a library function: its value, or 0 if the flag is set or the value not finite.
#[inline]
fn finish(s: &mut State, function: Builtin, value: f64, clear: bool) -> f64 {
    if clear || s.flag == Flag::Clear {
        s.flag = Flag::Clear;
        if value.is_finite() {
            return value;
        }
        s.flag = if value.is_nan() { Flag::Domain } else { Flag::Range };
    }
    let name = function.name();
    s.warn(if s.flag == Flag::Domain { Warning::Domain(name) } else { Warning::Range(name) });
    0.0
}

/// The end of a power, likewise.
#[inline]
fn power(s: &mut State, value: f64, clear: bool) -> f64 {
    if clear || s.flag == Flag::Clear {
        s.flag = Flag::Clear;
        if value.is_finite() {
            return value;
        }
        s.flag = if value.is_nan() { Flag::Domain } else { Flag::Range };
    }
    s.warn(Warning::IllegalPower);
    0.0
}

/// Which of `count` choices a selector takes; 0 asks for the count.
fn selected(selector: f64, count: u32) -> Option<u32> {
    let k = (selector + 0.5) as i64;
    (selector >= -0.5 && k <= i64::from(count)).then_some(k as u32)
}

/// `arg(i)`.
fn real(reals: &[f64], index: f64, constant: bool) -> Result<f64, Fault> {
    if constant {
        return Err(Fault::NoReals);
    }
    match (index + 0.5) as i64 {
        k if k < 1 => Ok(reals.len() as f64),
        k => reals.get(k as usize - 1).copied().ok_or(Fault::MissingReal(k as u64)),
    }
}

/// `in(n)`: a column of the record, or their number.
fn column(columns: &[f64], index: f64) -> f64 {
    match (index + 0.5) as i64 {
        k if k < 1 => columns.len() as f64,
        k => columns.get(k as usize - 1).copied().unwrap_or(0.0),
    }
}

/// The inputs, where there is a ray.
fn ray(channels: &[f64]) -> Result<&[f64; crate::CHANNELS], Fault> {
    channels.first_chunk().ok_or(Fault::NoRay)
}
