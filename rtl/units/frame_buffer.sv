// Frame buffer (126) of the bump-mapping processor, Figure 1; frame memory (300) of the figure shading device, Figure 1; pixel value
// buffer (360) of the texel value generator. Gathers the pixels of memory lines, writes each line as a whole, and flips the display.
//
// A line is 4 x 4 pixels for stamps, 16 x 1 for packets. Client 0 writes lines, client 1 flips. Colours go to memory, so they leave no trace here.
`default_nettype none
module frame_buffer #(parameter PACKETS = 0, LINES = 8, FLAGS = 512, LIMIT = 131072, PER_CYCLE = 64, LINE_BYTES = 64, BUFFERS = 2) (
    input  wire              clk, rst,
    input  wire              in0_valid,
    input  wire [`IN0_W-1:0] in0,
    output wire              in0_pop,
    input  wire              mem0_ready, mem1_ready,
    output wire              mem0_request, mem1_request,
    output wire [47:0]       mem0_address, mem1_address,
    output wire              start
);
    localparam FRAME = 0, FRAME_END = 4;
    wire free, item = in0[`IN0_item];
    wire [2:0] kind = in0[`IN0_kind +: 3];
    reg [15:0] width, height;
    reg drawing, ending;
    reg [2:0] buffer;
    wire has_unflagged;
    wire holds = ending || has_unflagged;
    assign start = free && (holds || in0_valid) && mem0_ready && mem1_ready;
    assign in0_pop = start && !holds;
    wire takes_item = in0_pop && item, takes_frame = in0_pop && !item && kind == FRAME;
    wire ends = start && drawing && (ending || (!holds && !item && kind == FRAME_END));
    // A token lies in one line. Pixels outside the picture do not count.
    wire any;
    wire [15:0] x, y, pixels;
    token_line #(.PACKETS(PACKETS)) of_token (.token(in0), .width, .height, .any, .x, .y, .pixels);
    wire [31:0] columns = PACKETS ? (width + 15) >> 4 : (width + 3) >> 2;
    wire [31:0] line = PACKETS ? y * columns + (x >> 4) : (y >> 2) * columns + (x >> 2);
    wire [31:0] new_width = in0[`IN0_width +: 16], new_height = in0[`IN0_height +: 16];
    wire [31:0] all = PACKETS ? new_height * ((new_width + 15) >> 4) : ((new_height + 3) >> 2) * ((new_width + 3) >> 2);
    wire is_newest, contains, evicts, is_found;
    wire [31:0] oldest, unflagged, found, set_cycles, examine_cycles;
    wire [7:0] gathered;
    wire gathers = takes_item && drawing && any && !is_newest;
    wire writes_gathered = ends && gathered != 0, examines = ends && gathered == 0, finishes = examines && !is_found;
    wire writes_unflagged = start && holds && !ending;
    gathered_lines #(.LINES(LINES)) gather (.clk, .clear(rst || takes_frame), .line, .touch(gathers), .take(writes_gathered),
        .is_newest, .contains, .evicts, .oldest, .count(gathered));
    line_flags #(.FLAGS(FLAGS), .LIMIT(LIMIT), .PER_CYCLE(PER_CYCLE)) flags (.clk, .rst, .set(takes_frame), .lines(all), .line,
        .draw(gathers), .examine(examines), .write_unflagged(writes_unflagged), .is_clear(), .has_unflagged, .is_found, .unflagged, .found,
        .set_cycles, .examine_cycles);
    wire [31:0] written = writes_unflagged ? unflagged : examines ? found : oldest;
    // Buffers of the swap chain are 2^27 bytes apart, and those beyond the second start at 2^40.
    wire [47:0] base = ({45'd0, buffer} << 27) + (buffer < 2 ? 48'd0 : 48'd1 << 40);
    assign mem0_request = evicts || writes_gathered || (examines && is_found) || writes_unflagged;
    assign mem0_address = base + written * LINE_BYTES;
    assign mem1_request = finishes;
    assign mem1_address = base;
    occupancy #(.W(32)) busy (.clk, .rst, .start, .free,
        .cycles(takes_item ? {16'd0, pixels} : takes_frame ? set_cycles : examines ? examine_cycles : 32'd1));
    always @(posedge clk)
        if (rst) begin
            drawing <= 1'b0;
            ending <= 1'b0;
            buffer <= 0;
            width <= 0;
            height <= 0;
        end else begin
            if (takes_frame) begin
                width <= in0[`IN0_width +: 16];
                height <= in0[`IN0_height +: 16];
                drawing <= 1'b1;
            end
            if (ends) ending <= !finishes;
            if (finishes) begin
                drawing <= 1'b0;
                buffer <= buffer == BUFFERS - 1 ? 3'd0 : buffer + 3'd1;
            end
        end
endmodule
`default_nettype wire
