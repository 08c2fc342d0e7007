// Identification of tiles (461) of the rate-limited renderer, Figures 5A and 5B: marks the tiles that textured pixels need.
//
// It tests a layer of a pixel per cycle (`engine.scan_rate` is 1), and gathers the distinct tiles of a block. Set-up registers hold the pages
// (132): size, Dmax (133), tile pitch (138) and tile base (140) of each layer. A token has up to MARKS tiles.
`default_nettype none
module identification #(parameter LATENCY = 8, PAGES = 4, LAYERS = 8, ACROSS = 6, DOWN = 6, HALF = 1, MARKS = 16) (
    input  wire               clk, rst,
    input  wire               in0_valid,
    input  wire [`IN0_W-1:0]  in0,
    output wire               in0_pop,
    input  wire               out0_room,
    output wire               out0_reserve, out0_push,
    output wire [`OUT0_W-1:0] out0,
    output wire               start
);
    localparam FRAME = 0, PAGE = 1, CELLS = 2, BEGIN = 3, END = 4, DIRECT = 16'hfffe;
    localparam CELL = `IN0_1_page - `IN0_0_page, MARK = `OUT0_1_valid - `OUT0_0_valid;
    // Dmax, reciprocals of height and width, height and width; base, rows, pitch, height and width of a layer.
    reg [135:0] pages [0:PAGES-1];
    reg [95:0] layers [0:PAGES*LAYERS-1];
    initial begin
        $readmemh("pages.hex", pages);
        $readmemh("layers.hex", layers);
    end
    reg walks, second;
    reg [`IN0_W-1:0] token;
    reg [15:0] rest;
    reg [`OUT0_W-1:0] list;
    reg [4:0] listed;
    reg [15:0] centre_x, centre_y;
    wire [`IN0_W-1:0] current = walks ? token : in0;
    wire [2:0] kind = current[`IN0_kind +: 3];
    reg [15:0] textured, pixels;
    reg [3:0] at;
    integer p;
    always @* begin
        for (p = 0; p < 16; p = p + 1)
            textured[p] = current[`IN0_mask + p] && current[`IN0_0_page + p * CELL +: 16] < DIRECT;
        pixels = walks ? rest : textured;
        at = 0;
        for (p = 15; p >= 0; p = p - 1) if (pixels[p]) at = p;
    end
    assign start = !walks && in0_valid && out0_room;
    assign in0_pop = start;
    wire works = kind == CELLS && pixels != 0;
    assign out0_reserve = start && (works || kind == FRAME || kind == PAGE || kind == END);
    // The layer of this cycle.
    wire [CELL-1:0] cell_data = current[`IN0_0_page + at * CELL +: CELL];
    wire [15:0] page = cell_data[15:0];
    wire [135:0] set_up = pages[page];
    wire [7:0] deepest = set_up[135:128];
    wire signed [31:0] whole;
    wire has_fraction;
    float_floor of_depth (.x(cell_data[`IN0_0_depth - `IN0_0_page +: 32]), .whole(), .number(whole), .has_fraction);
    wire is_finest = whole >= $signed({24'd0, deepest}), has_second = !is_finest && has_fraction;
    wire [7:0] layer = is_finest ? deepest : whole[7:0] + (walks && second);
    wire [95:0] of_layer = layers[page * LAYERS + layer];
    wire [31:0] s = cell_data[`IN0_0_s - `IN0_0_page +: 32], t = cell_data[`IN0_0_t - `IN0_0_page +: 32], inside_s, inside_t;
    wire [1:0] wrap_s = cell_data[`IN0_0_wrap_0 - `IN0_0_page +: 2], wrap_t = cell_data[`IN0_0_wrap_1 - `IN0_0_page +: 2];
    wrap_coordinate across (.s, .size(set_up[31:0]), .inverse(set_up[95:64]), .mode(wrap_s), .place(inside_s));
    wrap_coordinate down (.s(t), .size(set_up[63:32]), .inverse(set_up[127:96]), .mode(wrap_t), .place(inside_t));
    wire [15:0] x, right, y, below;
    axis_tap #(.HALF(HALF)) tap_s (.place(inside_s), .scaled_down(deepest - layer), .size(of_layer[15:0]), .repeats(wrap_s == 0), .first(x), .second(right));
    axis_tap #(.HALF(HALF)) tap_t (.place(inside_t), .scaled_down(deepest - layer), .size(of_layer[31:16]), .repeats(wrap_t == 0), .first(y), .second(below));
    wire goes_right = x >> ACROSS != right >> ACROSS, goes_down = y >> DOWN != below >> DOWN;
    wire [31:0] upper = of_layer[95:64] + (y >> DOWN) * of_layer[47:32], lower = of_layer[95:64] + (below >> DOWN) * of_layer[47:32];
    wire [127:0] tiles = {lower + (x >> ACROSS), lower + (right >> ACROSS), upper + (right >> ACROSS), upper + (x >> ACROSS)};
    wire [3:0] needed = {goes_down, goes_right && goes_down, goes_right, 1'b1};
    wire [15:0] block_x = current[`IN0_x +: 16] * 4 + 2, block_y = current[`IN0_y +: 16] * 4 + 2;
    wire [31:0] from_x = block_x > centre_x ? block_x - centre_x : centre_x - block_x;
    wire [31:0] from_y = block_y > centre_y ? block_y - centre_y : centre_y - block_y;
    reg [`OUT0_W-1:0] result;
    reg [4:0] count;
    reg found;
    integer i, m;
    always @* begin
        result = walks ? list : 0;
        count = walks ? listed : 0;
        found = 1'b0;
        result[`OUT0_kind +: 2] = kind == END ? 2'd3 : kind[1:0];
        if (works)
            for (i = 0; i < 4; i = i + 1)
                if (needed[i]) begin
                    found = 1'b0;
                    for (m = 0; m < MARKS; m = m + 1)
                        if (m < count && result[`OUT0_0_page + m * MARK +: 48] == {tiles[32*i +: 32], page}) begin
                            found = 1'b1;
                            result[`OUT0_0_pixels + m * MARK +: 5] = result[`OUT0_0_pixels + m * MARK +: 5] + 5'd1;
                        end
                    if (!found) begin
                        result[`OUT0_0_valid + count * MARK +: MARK] = {from_x * from_x + from_y * from_y, 5'd1, tiles[32*i +: 32], page, 1'b1};
                        count = count + 5'd1;
                    end
                end
    end
    wire ends_pixel = second && walks ? 1'b1 : !has_second;
    wire [15:0] left = ends_pixel ? pixels & (pixels - 16'd1) : pixels;
    wire is_active = start || walks, ends = !works || left == 0;
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) deliver (.clk, .rst, .put(walks ? ends : out0_reserve && ends), .data(result), .latency(LATENCY),
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
    always @(posedge clk)
        if (rst) begin
            walks <= 1'b0;
            centre_x <= 0;
            centre_y <= 0;
        end else if (is_active) begin
            walks <= !ends;
            second <= !ends_pixel;
            rest <= left;
            list <= result;
            listed <= count;
            if (start) begin
                token <= in0;
                if (kind == FRAME) begin
                    centre_x <= in0[`IN0_width +: 16] >> 1;
                    centre_y <= in0[`IN0_height +: 16] >> 1;
                end
            end
        end
endmodule
`default_nettype wire
