// Tile load lists (136) of the rate-limited renderer, and the acquisition of tiles (462, 477), Figures 4B and 6: a tile is not present (N), to
// be loaded (L) or exists (E).
//
// MODE is 0 for best resolution, 1 for progressive, 2 for conventional. A scan tests RATE tiles per cycle, page by page from layer Dmax (133) down.
// Set-up registers hold this order, and the sources of each tile, as tile pitch (138) and tile base (140) give them. Tiles of all pages are
// numbered through. The beginning of a view resets RATE tiles per cycle. A view ends after PICTURES pictures, never if 0. Holds for
// `tile.order` = listed, `engine.list_rate` up to 64, without `defer.left_at_tile` and `defer.left_at_ms`.
`default_nettype none
module tile_lists #(parameter LATENCY = 8, RATE = 16, MODE = 0, PICTURES = 0, TILES = 256, PAGES = 4, MARKS = 16) (
    input  wire               clk, rst,
    input  wire               in0_valid, in1_valid,
    input  wire [`IN0_W-1:0]  in0,
    input  wire [`IN1_W-1:0]  in1,
    output wire               in0_pop, in1_pop,
    input  wire               out0_room, out1_room, out2_room,
    output wire               out0_reserve, out0_push, out1_reserve, out1_push, out2_reserve, out2_push,
    output wire [`OUT0_W-1:0] out0,
    output wire [`OUT1_W-1:0] out1,
    output wire [`OUT2_W-1:0] out2,
    output wire               start
);
    localparam IDENTIFIED = 0, ACQUIRE = 1, IMPROVED = 2;
    localparam FRAME = 0, PAGE = 1, MARK = 2, END = 3;
    localparam [1:0] ANNOUNCE = 0, TILE = 1, LAST = 2, LOAD = 0, SYNTHESIZE = 1;
    localparam STRIDE = `IN0_1_valid - `IN0_0_valid, NONE = 16'hffff;
    // Sources, number and page of a tile; order of the scan; first tile of a page.
    reg [111:0] tiles [0:TILES-1];
    reg [15:0] order [0:TILES-1], firsts [0:PAGES];
    initial begin
        $readmemh("tiles.hex", tiles);
        $readmemh("order.hex", order);
        $readmemh("firsts.hex", firsts);
    end
    reg [TILES-1:0] load, exists;
    reg [1:0] phase;
    reg [15:0] pages, pictures, position, head, tail;
    reg scans;
    // Tiles to acquire, with a bit for those that are averaged.
    reg [16:0] plan [0:TILES-1];
    wire free, acquires_next = phase == ACQUIRE, improves = phase == IMPROVED;
    assign start = free && (acquires_next || (improves ? in1_valid : in0_valid)) && out0_room && out1_room && out2_room;
    assign in0_pop = start && phase == IDENTIFIED;
    assign in1_pop = start && improves;
    wire [`IN0_W-1:0] mark = improves ? in1 : in0;
    wire [1:0] kind = mark[`IN0_kind +: 2];
    wire takes = start && !acquires_next, takes_end = takes && kind == END;
    wire [15:0] known = firsts[pages];
    wire is_left = improves && PICTURES == pictures + 1;
    wire begins = takes_end && !is_left;
    // All tiles that will be in state L, and whether one of them has a source that will not exist.
    reg [TILES-1:0] wanted, present;
    reg has_load;
    integer i, j;
    always @* begin
        wanted = load;
        present = 0;
        has_load = 1'b0;
        if (begins) begin
            for (i = 0; i < TILES; i = i + 1)
                if (phase == IDENTIFIED && i < known && !exists[i] && (MODE == 2 || (MODE == 1 && tiles[i][16 +: 32] == 0))) wanted[i] = 1'b1;
            present = wanted | exists;
            for (i = 0; i < TILES; i = i + 1)
                if (wanted[i]) begin
                    if (tiles[i][48 +: 64] == {4{NONE[15:0]}}) has_load = 1'b1;
                    for (j = 0; j < 4; j = j + 1)
                        if (tiles[i][48 + 16*j +: 16] != NONE && !present[tiles[i][48 + 16*j +: 16]]) has_load = 1'b1;
                end
        end
    end
    wire is_complete = improves && (is_left || wanted == 0), goes_on = begins && !is_complete;
    reg [15:0] marked;
    always @* begin
        marked = 0;
        for (i = 0; i < MARKS; i = i + 1) marked = marked + mark[`IN0_0_valid + i * STRIDE];
    end
    // The next tile of the plan.
    wire acquires = start && acquires_next, has_next = head != tail;
    wire [16:0] next = plan[head];
    wire [111:0] next_tile = tiles[next[15:0]];
    wire loads = acquires && has_next && !next[16], finishes = acquires && !has_next;
    assign out0_reserve = (goes_on && has_load) || (takes_end && is_complete) || loads || (finishes && MODE != 1);
    assign out1_reserve = acquires;
    assign out2_reserve = (takes_end && improves) || (finishes && MODE != 1);
    wire [1:0] request = loads ? TILE : goes_on ? ANNOUNCE : LAST, store = !has_next ? LAST : next[16] ? SYNTHESIZE : LOAD;
    // A test and a reset pass over all lists.
    wire passes = begins || (takes && kind == FRAME);
    wire [15:0] scan = (known + RATE - 1) / RATE, cycles = passes && scan != 0 ? scan : takes && kind == MARK && marked != 0 ? marked : 16'd1;
    wire [15:0] latency = LATENCY + (takes_end ? cycles - 16'd1 : 16'd0);
    occupancy busy (.clk, .rst, .start, .cycles, .free);
    delivery #(.W(`OUT0_W), .DEPTH(`OUT0_DEPTH)) requests (.clk, .rst, .put(out0_reserve), .data({loads ? {next_tile[47:16], next_tile[15:0]} : 48'd0, request}),
        .latency, .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out0_push), .out(out0));
    delivery #(.W(`OUT1_W), .DEPTH(`OUT1_DEPTH)) orders (.clk, .rst, .put(out1_reserve), .data({has_next ? next_tile[47:0] : 48'd0, store}), .latency,
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out1_push), .out(out1));
    delivery #(.W(`OUT2_W), .DEPTH(`OUT2_DEPTH)) rounds (.clk, .rst, .put(out2_reserve), .data(goes_on), .latency,
        .counts(1'b0), .after(16'd0), .answered(32'd0), .asked(), .push(out2_push), .out(out2));
    reg [TILES-1:0] l, e;
    reg [15:0] of, last, source;
    reg averages;
    always @(posedge clk)
        if (rst) begin
            load <= 0;
            exists <= 0;
            phase <= IDENTIFIED;
            pages <= 0;
            pictures <= 0;
            scans <= 1'b0;
            head <= 0;
            tail <= 0;
        end else begin
            if (takes && kind == FRAME) begin
                load <= 0;
                pictures <= 0;
            end
            if (takes && kind == PAGE) pages <= pages + 16'd1;
            if (takes && kind == MARK)
                for (i = 0; i < MARKS; i = i + 1)
                    if (mark[`IN0_0_valid + i * STRIDE]) begin
                        of = firsts[mark[`IN0_0_page + i * STRIDE +: 16]] + mark[`IN0_0_tile + i * STRIDE +: 16];
                        if (!exists[of]) load[of] <= 1'b1;
                    end
            if (takes_end) begin
                pictures <= improves ? pictures + 16'd1 : pictures;
                phase <= is_complete ? IDENTIFIED : ACQUIRE;
            end
            if (begins || scans) begin
                // Figure 6: a tile in state L is averaged if all its sources exist, and otherwise loaded.
                l = begins ? wanted : load;
                e = exists;
                last = begins ? 16'd0 : tail;
                for (i = 0; i < RATE; i = i + 1)
                    if ((begins ? 0 : position) + i < known) begin
                        of = order[(begins ? 0 : position) + i];
                        averages = tiles[of][48 +: 64] != {4{NONE[15:0]}};
                        for (j = 0; j < 4; j = j + 1) begin
                            source = tiles[of][48 + 16*j +: 16];
                            if (source != NONE && !e[source]) averages = 1'b0;
                        end
                        if (l[of]) begin
                            plan[last] <= {averages, of};
                            last = last + 16'd1;
                            l[of] = 1'b0;
                            e[of] = 1'b1;
                        end
                    end
                load <= l;
                exists <= e;
                tail <= last;
                if (begins) head <= 0;
                position <= (begins ? 16'd0 : position) + RATE;
                scans <= (begins ? 16'd0 : position) + RATE < known;
            end
            if (acquires) begin
                if (has_next) head <= head + 16'd1;
                else phase <= MODE == 1 ? IMPROVED : IDENTIFIED;
            end
        end
endmodule
`default_nettype wire
