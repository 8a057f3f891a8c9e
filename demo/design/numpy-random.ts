/**
 * The random numbers of numpy's `default_rng(seed)`, so that a recipe makes the same foil here and by `diffraction bake`:
 * PCG64 with the output function XSL-RR (O'Neill 2014), seeded by numpy's SeedSequence (its NEP 19).
 */
export class NumpyRandom {
  #state: bigint
  readonly #increment: bigint

  /** @param seed - a whole number from 0 to 2⁵³ − 1 */
  constructor(seed: number) {
    const [a, b, c, d] = seedWords(seed)
    this.#increment = ((((c! << 64n) | d!) << 1n) | 1n) & MASK
    this.#state = this.#increment
    this.#state = (this.#state + ((a! << 64n) | b!)) & MASK
    this.#step()
  }

  /** From 0 on, below 1: 53 bits. */
  next(): number {
    this.#step()
    const folded = (this.#state >> 64n) ^ (this.#state & MASK64)
    const turn = this.#state >> 122n
    const output = ((folded >> turn) | (folded << (64n - turn))) & MASK64
    return Number(output >> 11n) * 2 ** -53
  }

  #step(): void {
    this.#state = (this.#state * MULTIPLIER + this.#increment) & MASK
  }
}

const MASK = (1n << 128n) - 1n
const MASK64 = (1n << 64n) - 1n
const MULTIPLIER = 0x2360ed051fc65da44385df649fccf645n
const POOL = 4

/** SeedSequence(seed).generate_state(4, uint64). */
function seedWords(seed: number): bigint[] {
  const pool = mixedPool(entropyOf(seed))
  let factor = 0x8b51f9dd
  const words = Array.from({ length: 2 * POOL }, (_, i) => {
    let word = pool[i % POOL]! ^ factor
    factor = Math.imul(factor, 0x58f38ded)
    word = Math.imul(word, factor)
    return (word ^ (word >>> 16)) >>> 0
  })
  return Array.from(
    { length: POOL },
    (_, i) => BigInt(words[2 * i]!) | (BigInt(words[2 * i + 1]!) << 32n),
  )
}

/** The seed in words of 32 bits, the lowest first. */
function entropyOf(seed: number): number[] {
  const words = [seed % 2 ** 32]
  if (seed >= 2 ** 32) words.push(Math.floor(seed / 2 ** 32))
  return words
}

function mixedPool(entropy: readonly number[]): number[] {
  let factor = 0x43b0d7e5
  const hashed = (value: number): number => {
    let word = value ^ factor
    factor = Math.imul(factor, 0x931e8875)
    word = Math.imul(word, factor)
    return word ^ (word >>> 16)
  }
  const mixed = (x: number, y: number): number => {
    const word = (Math.imul(0xca01f9dd, x) - Math.imul(0x4973f715, y)) | 0
    return word ^ (word >>> 16)
  }
  const pool = Array.from({ length: POOL }, (_, i) => hashed(entropy[i] ?? 0))
  for (let from = 0; from < POOL; from++)
    for (let to = 0; to < POOL; to++)
      if (from !== to) pool[to] = mixed(pool[to]!, hashed(pool[from]!))
  return pool
}
