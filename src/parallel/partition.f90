!> A block of tiles dealt out to ranks: equal work for each, and little surface between them.
!>
!> Work is of several kinds, done one after the other: each is over when its busiest rank is ready, so each is to be shared evenly.
!>
!> Often most of the block is empty. So only the box around all work is cut; a tile beyond goes with the nearest one of the box, not
!> counting ways through periodic faces.
module partition
  use handover, only: hand_over
  use kinds, only: wp
  use metis, only: idx_t, graph_t, cut_recursively, cut_directly
  use places, only: place_in_block, vertex_at, beside, loads
  implicit none
  private
  public :: partition_block, shift_borders, longest_time, relabel

  integer, parameter :: unevenness_of_halves = 5, unevenness = 30  !< permitted, in thousandths of the mean load
  integer, parameter :: few = 16                 !< parts up to which they are made by halving
  integer, parameter :: fewest_tiles = 8         !< of a part in the box around all work; else it is the whole block
  real(wp), parameter :: empty = 0.01_wp         !< work of all empty tiles together, relative to that of the others
  real(wp), parameter :: resolution = 1e7_wp     !< the whole work of a kind in METIS's integers
  real(wp), parameter :: edge_unit = 100.0_wp    !< a face between tiles of mean work, in METIS's integers
  real(wp), parameter :: edge_most = 2000.0_wp

contains

  !> Part 0 to parts - 1 of every tile of an n(1) x n(2) x n(3) block, x fastest.
  !> Every part gets a tile if there are enough; `ok` is false if METIS fails.
  subroutine partition_block(n, periodic, area, work, parts, part, ok)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: area(3)   !< face of a tile across each direction [m2]
    real(wp), intent(in) :: work(:,:)   !< (kinds, tiles) [any unit]
    integer, intent(in) :: parts
    integer, intent(out) :: part(:)   !< (tiles)
    logical, intent(out) :: ok

    integer, allocatable :: within(:), cut(:)
    integer :: i, low(3), extent(3)

    ok = .true.
    part = [(i, i=0, size(part) - 1)]
    if (parts >= size(part)) return
    part = 0
    if (parts == 1) return

    call take_box(n, work, parts, low, extent, within)
    allocate (cut(size(within)))
    call cut_block(extent, periodic .and. extent == n, area, work(:, within), parts, cut, ok)
    if (.not. ok) return
    call hand_over(extent, periodic .and. extent == n, area, work(:, within), parts, cut)
    call spread_box(n, low, extent, cut, part)
  end subroutine partition_block

  !> Hand tiles over at the borders between the parts, all of which must be in the box already: else nothing changes.
  subroutine shift_borders(n, periodic, area, work, parts, part)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: area(3), work(:,:)  !< as for partition_block
    integer, intent(in) :: parts
    integer, intent(inout) :: part(:)

    integer, allocatable :: within(:), cut(:)
    integer :: low(3), extent(3), i
    logical :: met(0:parts - 1)

    call take_box(n, work, parts, low, extent, within)
    cut = part(within)
    met = .false.
    do i = 1, size(cut)
      met(cut(i)) = .true.
    end do
    if (.not. all(met)) return
    call hand_over(extent, periodic .and. extent == n, area, work(:, within), parts, cut)
    call spread_box(n, low, extent, cut, part)
  end subroutine shift_borders

  !> The tiles of the box that is cut.
  pure subroutine take_box(n, work, parts, low, extent, within)
    integer, intent(in) :: n(3), parts
    real(wp), intent(in) :: work(:,:)
    integer, intent(out) :: low(3), extent(3)  !< lowest place, and how many tiles it is wide
    integer, allocatable, intent(out) :: within(:)

    integer :: i

    call find_box(n, any(work > 0, 1), fewest_tiles*parts, low, extent)
    allocate (within(product(extent)))
    do i = 1, size(within)
      within(i) = 1 + vertex_at(n, low + place_in_block(extent, i - 1))
    end do
  end subroutine take_box

  !> The parts of the box become those of the block.
  pure subroutine spread_box(n, low, extent, cut, part)
    integer, intent(in) :: n(3), low(3), extent(3), cut(:)
    integer, intent(out) :: part(:)

    integer :: i

    do i = 1, size(part)
      part(i) = cut(1 + vertex_at(extent, min(max(place_in_block(n, i - 1) - low, 0), extent - 1)))
    end do
  end subroutine spread_box

  !> The box around all marked tiles, by its lowest place and how many tiles it is wide; the whole block if that box has less
  !> than `fewest` tiles.
  pure subroutine find_box(n, marked, fewest, low, extent)
    integer, intent(in) :: n(3)
    logical, intent(in) :: marked(:)   !< (tiles)
    integer, intent(in) :: fewest
    integer, intent(out) :: low(3), extent(3)

    integer :: high(3), v

    low = n
    high = -1
    do v = 1, size(marked)
      if (.not. marked(v)) cycle
      low = min(low, place_in_block(n, v - 1))
      high = max(high, place_in_block(n, v - 1))
    end do
    extent = high - low + 1
    if (product(max(extent, 0)) < fewest) then
      low = 0
      extent = n
    end if
  end subroutine find_box

  !> The block that is cut, of more tiles than parts.
  subroutine cut_block(n, periodic, area, work, parts, part, ok)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: area(3), work(:,:)
    integer, intent(in) :: parts
    integer, intent(out) :: part(:)
    logical, intent(out) :: ok

    type(graph_t) :: graph
    real(wp) :: weight(size(work, 1), size(part))
    integer :: i

    do i = 1, size(work, 1)
      weight(i, :) = levelled(parts, with_floor(work(i, :)))
    end do
    graph = block_graph(n, periodic, area, weight)
    if (parts <= few) then
      call cut_recursively(graph, parts, unevenness_of_halves, part, ok)
    else
      call cut_directly(graph, parts, unevenness, part, ok)
    end if
    if (ok) call fill_empty(parts, sum(weight, 1), part)
  end subroutine cut_block

  !> The work of each tile, with a little for those that have none: they are still looked at, and they
  !> should go to the rank whose parcels will fly there.
  pure function with_floor(work) result(weight)
    real(wp), intent(in) :: work(:)
    real(wp) :: weight(size(work))

    weight = 1
    if (any(work > 0)) weight = max(work, empty*sum(work)/size(work))
  end function with_floor

  !> Tiles that are more than a rank's fair share count as that share: such a tile gets a rank of its own, and
  !> its excess must not distort the balance of the others.
  pure function levelled(parts, work) result(weight)
    integer, intent(in) :: parts
    real(wp), intent(in) :: work(:)
    real(wp) :: weight(size(work))

    real(wp) :: share
    integer :: round

    weight = work
    do round = 1, 40
      share = sum(weight)/parts
      if (maxval(weight) <= 1.01_wp*share) exit
      weight = min(weight, share)
    end do
  end function levelled

  !> Tiles joined across faces. An edge weighs what would be exchanged through it: parcels in proportion to the
  !> area and to the work on both sides.
  pure function block_graph(n, periodic, area, weight) result(graph)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: area(3), weight(:,:)
    type(graph_t) :: graph

    integer :: v, a, side, m, there, place(3)
    real(wp) :: whole(size(weight, 2)), mean

    associate (kinds => size(weight, 1), vertices => size(weight, 2))
      allocate (graph%first(vertices + 1), graph%weight(kinds, vertices))
      allocate (graph%neighbour(6*vertices), graph%edge(6*vertices))
      do a = 1, kinds
        graph%weight(a, :) = int(max(1.0_wp, anint(weight(a, :)*max(resolution, 100.0_wp*vertices)/sum(weight(a, :)))), idx_t)
      end do
    end associate
    whole = sum(weight, 1)  ! of all kinds
    mean = sum(whole**2)/sum(whole)
    graph%first(1) = 0
    m = 0
    do v = 1, size(whole)
      place = place_in_block(n, v - 1)
      do a = 1, 3
        do side = -1, 1, 2
          there = beside(n, periodic, place, a, side)
          if (there < 0) cycle
          m = m + 1
          graph%neighbour(m) = int(there, idx_t)
          graph%edge(m) = int(max(1.0_wp, min(edge_most, edge_unit*area(a)/maxval(area) &
                                              *(0.1_wp + 0.5_wp*(whole(v) + whole(there + 1))/mean))), idx_t)
        end do
      end do
      graph%first(v + 1) = int(m, idx_t)
    end do
  end function block_graph

  !> Work of the busiest part, which may be another for each kind.
  pure function longest_time(parts, work, part) result(longest)
    integer, intent(in) :: parts
    real(wp), intent(in) :: work(:,:)  !< (kinds, tiles)
    integer, intent(in) :: part(:)     !< (tiles) from 0
    real(wp) :: longest

    longest = sum(maxval(loads(parts, work, part), 2))
  end function longest_time

  !> Give each part without a tile the lightest one of the part that has most tiles.
  pure subroutine fill_empty(parts, weight, part)
    integer, intent(in) :: parts
    real(wp), intent(in) :: weight(:)
    integer, intent(inout) :: part(:)

    integer :: tiles(0:parts - 1), p, v, rich

    tiles = 0
    do v = 1, size(part)
      tiles(part(v)) = tiles(part(v)) + 1
    end do
    do p = 0, parts - 1
      if (tiles(p) > 0) cycle
      rich = maxloc(tiles, dim=1) - 1
      part(minloc(weight, dim=1, mask=part == rich)) = p
      tiles(rich) = tiles(rich) - 1
      tiles(p) = 1
    end do
  end subroutine fill_empty

  !> Name the parts so that as much work as possible stays where it is: the largest overlap of an old and a new
  !> part first, then the largest among those left.
  pure subroutine relabel(parts, work, old, part)
    integer, intent(in) :: parts
    real(wp), intent(in) :: work(:)     !< (tiles)
    integer, intent(in) :: old(:)       !< (tiles) from 0
    integer, intent(inout) :: part(:)   !< (tiles) from 0

    real(wp) :: overlap(0:parts - 1, 0:parts - 1), largest(0:parts - 1), weight(size(work))
    integer :: favourite(0:parts - 1), name(0:parts - 1), v, p, named
    logical :: free(0:parts - 1)

    weight = with_floor(work)
    overlap = 0
    do v = 1, size(work)
      overlap(old(v), part(v)) = overlap(old(v), part(v)) + weight(v)
    end do
    largest = maxval(overlap, dim=1)
    favourite = maxloc(overlap, dim=1) - 1
    free = .true.
    named = 0
    do while (named < parts)
      p = maxloc(largest, dim=1) - 1
      if (free(favourite(p))) then
        name(p) = favourite(p)
        free(favourite(p)) = .false.
        largest(p) = -1
        named = named + 1
      else
        favourite(p) = maxloc(overlap(:, p), dim=1, mask=free) - 1
        largest(p) = overlap(favourite(p), p)
      end if
    end do
    part = name(part)
  end subroutine relabel

end module partition
