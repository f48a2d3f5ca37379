!> Tiles: who owns what, who must see what, and how evenly the work is dealt out.
program test_tiles
  use check, only: expect_all, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use kinds, only: wp, i8
  use tiles, only: tiles_t, new_tiles, most_images
  implicit none

  type(communicator_t) :: comm
  integer(i8) :: seed

  call start_ranks(comm)
  seed = 1
  call geometry()
  call ghosts([5, 4, 6], [.false., .false., .false.], 'closed')
  call ghosts([5, 4, 6], [.true., .true., .true.], 'periodic')
  call ghosts([1, 2, 3], [.true., .true., .true.], 'periodic, one, two and three tiles')
  call ghosts([2, 1, 7], [.false., .true., .true.], 'one periodic tile thick')
  call ghosts([1, 1, 4], [.false., .false., .true.], 'a pipe')
  call ghosts([1, 1, 1], [.true., .true., .true.], 'a single tile')
  call balance([24, 6, 40], 'a bed')
  call balance([12, 1, 60], 'a thin bed')
  call wandering()
  call beyond()
  call heavy()
  call few()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  subroutine geometry()
    type(tiles_t) :: tiles
    real(wp) :: low(3), high(3), x(3)
    integer :: t
    logical :: right

    tiles = new_tiles(comm, [-1.0_wp, 0.0_wp, 2.0_wp], [1.0_wp, 0.35_wp, 3.0_wp], [.false., .false., .true.], &
                      spread(0.1_wp, 1, 3))
    call expect_all(all(tiles%n == [20, 3, 10]), 'tiles are no thinner than asked for')
    right = .true.
    do t = 1, tiles%total
      call tiles%bounds(t, low, high)
      right = right .and. tiles%tile_of(0.999_wp*low + 0.001_wp*high) == t
      right = right .and. tiles%tile_of(0.001_wp*low + 0.999_wp*high) == t
    end do
    call expect_all(right, 'each tile holds its corners')
    call expect_all(tiles%tile_of([-1.01_wp, 0.4_wp, 2.55_wp]) == tiles%tile_of([-0.99_wp, 0.34_wp, 2.55_wp]), &
                    'a parcel outside a wall belongs to the tile at the wall')
    call expect_all(tiles%owner_of([0.0_wp, 0.1_wp, 3.02_wp]) == tiles%owner_of([0.0_wp, 0.1_wp, 2.02_wp]), &
                    'a parcel beyond a periodic face belongs to the opposite tile')
    x = [-1.2_wp, 0.1_wp, 1.7_wp]
    call tiles%wrap(x)
    call expect_all(all(abs(x - [-1.2_wp, 0.1_wp, 2.7_wp]) < 1e-12_wp), 'positions wrap where the domain is periodic')
    x(3) = nearest(2.0_wp, -1.0_wp)
    call tiles%wrap(x)
    call expect_all(x(3) >= 2 .and. x(3) < 3, 'a rounding error outside is inside after wrapping')
    call expect_all(sum([size(tiles%mine)]) == count(tiles%owner == comm%rank), 'my tiles are those I own')
    call expect_all(same_everywhere(tiles%owner), 'all ranks agree on the owners')
  end subroutine geometry

  !> Images of random parcels, a few of them outside the domain, against a search of all tiles and shifts.
  subroutine ghosts(n, periodic, name)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    type(tiles_t) :: tiles
    integer :: parcel, found, expected, rank(most_images), all_rank(125), m
    real(wp) :: x(3), shift(3, most_images), all_shift(3, 125), extent(3), range
    logical :: right

    extent = n*[0.11_wp, 0.1_wp, 0.105_wp]
    tiles = new_tiles(comm, [0.0_wp, 1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp] + extent, periodic, spread(0.1_wp, 1, 3))
    right = all(tiles%n == n)
    call expect_all(right, name//': the tiles intended')
    if (n(1)*n(2)*n(3) > 60) call tiles%set_owners(scattered(tiles%total))
    do parcel = 1, 3000
      x = [0.0_wp, 1.0_wp, 0.0_wp] + extent*([random(), random(), random()]*1.02_wp - 0.01_wp)
      range = 0.1_wp*random()
      if (tiles%owner_of(x) /= comm%rank) cycle
      call tiles%images(x, range, rank, shift, found)
      call search(tiles, x, range, all_rank, all_shift, expected)
      right = right .and. found == expected
      do m = 1, found
        right = right .and. listed(rank(m), shift(:, m), all_rank(:expected), all_shift(:, :expected))
        right = right .and. .not. listed(rank(m), shift(:, m), rank(:m - 1), shift(:, :m - 1))
      end do
    end do
    call expect_all(right, name//': images are where they are needed, once, and nowhere else')
  end subroutine ghosts

  !> Every (rank, shift) with a tile within range, by looking at each tile from each of up to 125 shifts.
  subroutine search(tiles, x, range, rank, shift, count)
    type(tiles_t), intent(in) :: tiles
    real(wp), intent(in) :: x(3), range
    integer, intent(inout) :: rank(:)
    real(wp), intent(inout) :: shift(:,:)
    integer, intent(out) :: count

    integer :: t, i, s(3)
    real(wp) :: low(3), high(3), way(3)
    logical :: near

    count = 0
    do t = 1, tiles%total
      call tiles%bounds(t, low, high)
      where (.not. tiles%periodic .and. tiles%place_of(t) == 0) low = -huge(1.0_wp)
      where (.not. tiles%periodic .and. tiles%place_of(t) == tiles%n - 1) high = huge(1.0_wp)
      do i = 0, 124
        s = [modulo(i, 5), modulo(i/5, 5), i/25] - 2
        if (any(s /= 0 .and. .not. tiles%periodic)) cycle
        way = s*(tiles%upper - tiles%lower)
        near = sum((max(0.0_wp, low - x - way, x + way - high)/range)**2) <= 1
        if (.not. near) cycle
        if (tiles%owner(t) == comm%rank .and. all(s == 0)) cycle
        if (listed(tiles%owner(t), way, rank(:count), shift(:, :count))) cycle
        count = count + 1
        rank(count) = tiles%owner(t)
        shift(:, count) = way
      end do
    end do
  end subroutine search

  pure function listed(owner, way, rank, shift)
    integer, intent(in) :: owner, rank(:)
    real(wp), intent(in) :: way(3), shift(:,:)
    logical :: listed

    integer :: m

    listed = .false.
    do m = 1, size(rank)
      listed = listed .or. (owner == rank(m) .and. all(abs(way - shift(:, m)) < 1e-9_wp))
    end do
  end function listed

  !> Owners without any order, so that all kinds of borders occur.
  function scattered(total) result(owner)
    integer, intent(in) :: total
    integer :: owner(total)

    integer :: t

    owner = [(modulo(t*t/3, comm%size), t=1, total)]
  end function scattered

  !> A dense bed with a bubble under an empty freeboard, then the bubble moved.
  subroutine balance(n, name)
    integer, intent(in) :: n(3)
    character(len=*), intent(in) :: name

    type(tiles_t) :: tiles
    integer, allocatable :: before(:)
    real(wp), allocatable :: work(:,:), mine(:,:)
    real(wp) :: uneven
    logical :: changed

    tiles = new_tiles(comm, [0.0_wp, 0.0_wp, 0.0_wp], n*0.1_wp, [.false., .false., .false.], spread(0.0999_wp, 1, 3))
    work = bed(tiles, 0.3_wp)
    mine = work/comm%size
    uneven = tiles%imbalance(mine)
    call expect_all(comm%size == 1 .or. uneven > 1.2_wp, name//': equal boxes are not balanced')
    call tiles%repartition(mine, changed)
    call expect_all(tiles%imbalance(mine) <= 1.10_wp, name//': the load is balanced within 10 %')
    call expect_all(abs(tiles%imbalance(mine) - longest(tiles, work)) < 1e-9_wp, name//': the imbalance is that of each kind')
    call expect_all(same_everywhere(tiles%owner), name//': all ranks agree on the owners')
    call expect_all(size(tiles%mine) > 0, name//': every rank has a tile')
    if (comm%is_root()) print '(a,f7.4,a,i0)', '     imbalance ', longest(tiles, work), ', tiles at borders ', border(tiles)
    allocate (before, source=tiles%owner)
    call tiles%repartition(mine, changed)
    call expect_all(.not. changed .and. all(tiles%owner == before), name//': the same work, the same owners')

    work = bed(tiles, 0.45_wp)
    call tiles%repartition(work/comm%size, changed)
    call expect_all(tiles%imbalance(work/comm%size) <= 1.10_wp, name//': balanced again when the bubble has moved')
    call expect_all(sum(work(1, :), mask=tiles%owner /= before) <= 0.6_wp*sum(work(1, :)), name//': most parcels stay')
    if (comm%is_root()) print '(a,f7.4)', '     moved ', sum(work(1, :), mask=tiles%owner /= before)/sum(work(1, :))
  end subroutine balance

  !> Parcels per tile: 40 in the bed, none above, few in the bubble at a given height relative to the vessel's; and their contacts,
  !> the fewer the higher.
  function bed(tiles, height) result(work)
    type(tiles_t), intent(in) :: tiles
    real(wp), intent(in) :: height
    real(wp), allocatable :: work(:,:)  !< (2, tiles)

    integer :: t
    real(wp) :: low(3), high(3), centre(3)

    allocate (work(2, tiles%total), source=0.0_wp)
    centre = tiles%upper*[0.4_wp, 0.5_wp, height]
    do t = 1, tiles%total
      call tiles%bounds(t, low, high)
      if (high(3) < 0.4_wp*tiles%upper(3)) work(1, t) = 40
      if (sum((low + high - 2*centre)**2) < (0.5_wp*tiles%upper(1))**2) work(1, t) = 2
      work(2, t) = work(1, t)*(4 - 8*low(3)/tiles%upper(3))
    end do
  end function bed

  !> The busiest rank of each kind over the mean of all.
  function longest(tiles, work)
    type(tiles_t), intent(in) :: tiles
    real(wp), intent(in) :: work(:,:)
    real(wp) :: longest

    integer :: rank, k

    longest = 0
    do k = 1, 2
      longest = longest + maxval([(sum(work(k, :), mask=tiles%owner == rank), rank=0, comm%size - 1)])*comm%size/sum(work)
    end do
  end function longest

  !> Tiles with a neighbour of another rank above, behind or beside.
  function border(tiles)
    type(tiles_t), intent(in) :: tiles
    integer :: border

    integer :: owner(tiles%n(1), tiles%n(2), tiles%n(3))

    owner = reshape(tiles%owner, tiles%n)
    border = count(owner(2:, :, :) /= owner(:tiles%n(1) - 1, :, :)) + &
             count(owner(:, 2:, :) /= owner(:, :tiles%n(2) - 1, :)) + &
             count(owner(:, :, 2:) /= owner(:, :, :tiles%n(3) - 1))
  end function border

  !> A rank that has a few percent more to do than the others hands tiles at its border over, no more than that takes, and the
  !> border stays flat.
  subroutine wandering()
    type(tiles_t) :: tiles
    integer, allocatable :: before(:)
    real(wp), allocatable :: work(:,:)
    real(wp) :: excess
    integer :: faces, t
    logical :: changed

    tiles = new_tiles(comm, [0.0_wp, 0.0_wp, 0.0_wp], [1.6_wp, 2.4_wp, 0.4_wp], [.false., .false., .false.], &
                      spread(0.0999_wp, 1, 3))
    if (comm%size == 1) return
    allocate (work(2, tiles%total), source=10.0_wp)
    allocate (before, source=tiles%owner)
    faces = border(tiles)
    work(:, pack([(t, t=1, tiles%total)], before == 0)) = 10.4_wp
    excess = (longest(tiles, work) - 1)*sum(work)/comm%size
    call expect_all(longest(tiles, work) > 1.015_wp .and. longest(tiles, work) < 1.03_wp, 'work has wandered')
    call tiles%repartition(work/comm%size, changed)
    call expect_all(changed .and. longest(tiles, work) < 1.01_wp, 'it is evened out')
    call expect_all(sum(work, mask=spread(tiles%owner /= before, 1, 2)) < 1.2_wp*excess*(comm%size - 1), 'with few tiles')
    call expect_all(border(tiles) <= 1.15_wp*faces, 'at borders that stay flat')
  end subroutine wandering

  !> Tiles around all work go with the nearest of those that have some.
  subroutine beyond()
    integer, parameter :: n(3) = [12, 10, 9], low(3) = [3, 0, 2], high(3) = [8, 7, 5]
    type(tiles_t) :: tiles
    real(wp), allocatable :: work(:,:)
    logical :: changed, with_nearest
    integer :: t, place(3)

    tiles = new_tiles(comm, [0.0_wp, 0.0_wp, 0.0_wp], n*0.1_wp, [.false., .false., .true.], spread(0.0999_wp, 1, 3))
    allocate (work(1, tiles%total), source=0.0_wp)
    do t = 1, tiles%total
      place = tiles%place_of(t)
      if (all(place >= low .and. place <= high)) work(1, t) = merge(3.0_wp, 1.0_wp, place(1) < 5)
    end do
    call tiles%repartition(work/comm%size, changed)
    with_nearest = .true.
    do t = 1, tiles%total
      place = min(max(tiles%place_of(t), low), high)
      with_nearest = with_nearest .and. tiles%owner(t) == tiles%owner(1 + place(1) + n(1)*(place(2) + n(2)*place(3)))
    end do
    call expect_all(with_nearest, 'empty tiles go with the nearest that has work')
    call expect_all(tiles%imbalance(work/comm%size) < 1.05_wp, 'which is shared evenly')
  end subroutine beyond

  !> All work is in tiles of one rank, and nearly all in one tile, so dealing them out is not worth it: others keep theirs.
  subroutine heavy()
    type(tiles_t) :: tiles
    real(wp), allocatable :: work(:,:)
    logical :: changed
    integer :: t

    tiles = new_tiles(comm, [0.0_wp, 0.0_wp, 0.0_wp], [1.6_wp, 1.6_wp, 0.1_wp], [.false., .false., .false.], &
                      spread(0.0999_wp, 1, 3))
    allocate (work(1, tiles%total), source=0.0_wp)
    do t = 1, tiles%total
      if (tiles%owner(t) == 0) work(1, t) = 1
    end do
    work(1, findloc(tiles%owner, 0)) = 1.0e5_wp
    call tiles%repartition(work/comm%size, changed)
    call expect_all(size(tiles%mine) > 0, 'every rank has a tile when all work is in tiles of one')
  end subroutine heavy

  !> As many tiles as ranks, fewer, and one heavy tile: nobody is left out as long as there are enough.
  subroutine few()
    type(tiles_t) :: tiles
    real(wp) :: work(1, 8)
    real(wp), allocatable :: load(:,:)
    logical :: changed

    tiles = new_tiles(comm, [0.0_wp, 0.0_wp, 0.0_wp], [0.4_wp, 0.2_wp, 0.1_wp], [.false., .false., .false.], &
                      spread(0.1_wp, 1, 3))
    call expect_all(size(tiles%mine) > 0, 'eight tiles are enough for every rank')
    work = 0
    if (comm%is_root()) work(1, 1:8:7) = [1000, 1]
    call tiles%repartition(work, changed)
    call expect_all(size(tiles%mine) > 0, 'also when one of them has all the work')
    tiles = new_tiles(comm, [0.0_wp, 0.0_wp, 0.0_wp], [0.4_wp, 0.1_wp, 0.1_wp], [.true., .true., .true.], &
                      spread(0.1_wp, 1, 3))
    call expect_all(size(tiles%mine) == 4/comm%size, 'four tiles for one, two and four ranks')
    allocate (load(1, tiles%total), source=0.0_wp)
    call expect_close_root(tiles%imbalance(load), 1.0_wp, 'no load is balanced')
    load(1, tiles%mine) = (real(comm%rank, wp) + 1)/size(tiles%mine)
    call expect_close_root(tiles%imbalance(load), 2.0_wp*comm%size/(comm%size + 1), 'imbalance is the largest load over the mean')
    call two_kinds(tiles)
  end subroutine few

  !> The more a rank has of one kind of work, the less it has of the other: as much in all, and not balanced.
  subroutine two_kinds(tiles)
    type(tiles_t), intent(inout) :: tiles

    real(wp) :: load(2, tiles%total)
    logical :: changed

    load = 0
    load(1, tiles%mine) = (comm%rank + 1.0_wp)/size(tiles%mine)
    load(2, tiles%mine) = real(comm%size - comm%rank, wp)/size(tiles%mine)
    call expect_close_root(tiles%imbalance(load), 2.0_wp*comm%size/(comm%size + 1), 'imbalance is that of each kind of work')
    if (comm%size /= 2) return  ! four ranks have a tile each
    load = 0
    load(1 + comm%rank, tiles%mine) = 1
    call tiles%repartition(load, changed)
    call expect_all(changed .and. abs(tiles%imbalance(load) - 1) < 0.01_wp, 'tiles change hands until each kind is even')
  end subroutine two_kinds

  function same_everywhere(list) result(same)
    integer, intent(in) :: list(:)
    logical :: same

    integer :: theirs(size(list))

    theirs = list
    call comm%broadcast(theirs)
    same = all(theirs == list)
  end function same_everywhere

  !> Uniform in [0,1), the same sequence on every rank.
  function random()
    real(wp) :: random

    seed = modulo(seed*16807_i8, 2147483647_i8)
    random = real(seed, wp)/2147483647.0_wp
  end function random

  subroutine expect_close_root(value, expected, name)
    real(wp), intent(in) :: value, expected
    character(len=*), intent(in) :: name

    if (comm%is_root()) call expect_close(value, expected, 1e-12_wp, name)
  end subroutine expect_close_root

end program test_tiles
