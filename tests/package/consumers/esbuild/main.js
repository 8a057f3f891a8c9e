import { drawScene } from '../scene.js'

await drawScene('maps/baked/')
