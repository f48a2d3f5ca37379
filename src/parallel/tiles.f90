!> Space cut into equal tiles, and the tiles dealt out to the ranks: who owns a parcel, and who must see it.
!>
!> A tile at a wall reaches beyond it without end, so that a parcel slightly outside belongs to the nearest tile.
!> All ranks know the owner of every tile.
module tiles
  use, intrinsic :: iso_fortran_env, only: error_unit
  use communicator, only: communicator_t, abort_ranks
  use kinds, only: wp
  use metis, only: metis_fits
  use outcome, only: exit_environment
  use partition, only: partition_block, shift_borders, longest_time, relabel
  use places, only: place_in_block, vertex_at, loads
  implicit none
  private
  public :: tiles_t, new_tiles, most_images

  integer, parameter :: most_images = 27       !< of one parcel, which has so many tiles around, its own included
  real(wp), parameter :: tolerated = 1.03_wp   !< time over that of even work, above which all is cut anew
  real(wp), parameter :: worth_it = 0.98_wp    !< a new cut is taken if it lowers the time to this share

  type :: tiles_t
    type(communicator_t) :: comm
    real(wp) :: lower(3), upper(3)         !< corners of the domain [m]
    logical :: periodic(3)
    integer :: n(3)                        !< tiles in each direction
    integer :: total                       !< tiles, counted from 1, x fastest
    real(wp) :: width(3)                   !< edges of a tile [m]
    integer, allocatable :: owner(:)       !< (total) rank of each tile, the same on all ranks; set by `set_owners`
    integer, allocatable :: mine(:)        !< my tiles, ascending
    real(wp), private :: per_metre(3)      !< 1/width [1/m]
    logical, allocatable, private :: inner(:)  !< (total) mine, and so are all tiles around, none across a periodic face
  contains
    procedure :: tile_of
    procedure :: owner_of
    procedure :: place_of
    procedure :: bounds
    procedure :: wrap
    procedure :: images
    procedure :: set_owners
    procedure :: repartition
    procedure :: imbalance
  end type tiles_t

contains

  !> As many tiles as fit without being thinner than `width`, dealt out as if each meant the same work.
  function new_tiles(comm, lower, upper, periodic, width) result(tiles)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: lower(3), upper(3)  !< corners of the domain [m]
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: width(3)            !< least edges of a tile [m]
    type(tiles_t) :: tiles

    integer :: i
    real(wp), allocatable :: work(:,:)

    if (.not. metis_fits()) call give_up(comm, 'METIS was built with integers of 64 bits; 32 are needed')
    tiles%comm = comm
    tiles%lower = lower
    tiles%upper = upper
    tiles%periodic = periodic
    tiles%n = max(1, int((upper - lower)/width*(1 + 1e-9_wp)))
    tiles%total = product(tiles%n)
    tiles%width = (upper - lower)/tiles%n
    tiles%per_metre = tiles%n/(upper - lower)
    allocate (work(1, tiles%total), source=1.0_wp)
    call tiles%set_owners(dealt_out(tiles, work, [(0, i=1, tiles%total)]))
  end function new_tiles

  subroutine give_up(comm, message)
    type(communicator_t), intent(in) :: comm
    character(len=*), intent(in) :: message

    write (error_unit, '(a,i0,2a)') 'rank ', comm%rank, ': ', message
    call abort_ranks(comm, exit_environment)
  end subroutine give_up

  !> Take these owners, as computed or as read from a restart file, and what follows from them.
  subroutine set_owners(self, owner)
    class(tiles_t), intent(inout) :: self
    integer, intent(in) :: owner(:)  !< (total) ranks

    integer :: t, i, j, k, place(3)

    if (any(owner < 0 .or. owner >= self%comm%size)) error stop 'tiles: an owner that is no rank'
    self%owner = owner
    self%mine = pack([(t, t=1, self%total)], owner == self%comm%rank)
    if (allocated(self%inner)) deallocate (self%inner)
    allocate (self%inner(self%total), source=.false.)
    do t = 1, size(self%mine)
      place = self%place_of(self%mine(t))
      self%inner(self%mine(t)) = .true.
      do k = -1, 1
        do j = -1, 1
          do i = -1, 1
            if (concerns_others(self, place + [i, j, k])) self%inner(self%mine(t)) = .false.
          end do
        end do
      end do
    end do
  end subroutine set_owners

  !> Whether a place is another rank's, or any rank's across a periodic face.
  pure function concerns_others(self, place)
    class(tiles_t), intent(in) :: self
    integer, intent(in) :: place(3)
    logical :: concerns_others

    if (any(place < 0 .or. place >= self%n)) then
      concerns_others = all(self%periodic .or. (place >= 0 .and. place < self%n))
    else
      concerns_others = self%owner(tile_at(self%n, place)) /= self%comm%rank
    end if
  end function concerns_others

  !> Share the work evenly: hand tiles over at the borders or, where that is not enough, deal all out anew. All ranks take part;
  !> weights of the same tile from several ranks are added, so parcels may be counted by whichever rank holds them. Owners stay
  !> if new ones would not be worth it.
  subroutine repartition(self, weights, changed)
    class(tiles_t), intent(inout) :: self
    real(wp), intent(in) :: weights(:,:)  !< (kinds, total) work in each tile, as far as this rank knows, see partition [any unit]
    logical, intent(out) :: changed       !< whether any tile has another owner now

    real(wp) :: work(size(weights, 1), self%total)
    integer :: owner(self%total), k

    do k = 1, size(work, 1)
      work(k, :) = self%comm%sum(weights(k, :))
    end do
    owner = dealt_out(self, work, self%owner)
    changed = any(owner /= self%owner)
    if (changed) call self%set_owners(owner)
  end subroutine repartition

  !> New owners, from the root, for work known to all. They keep as much of it in place as they can.
  function dealt_out(self, work, old) result(owner)
    class(tiles_t), intent(in) :: self
    real(wp), intent(in) :: work(:,:)  !< (kinds, total) [any unit]
    integer, intent(in) :: old(:)      !< (total) ranks
    integer :: owner(size(old))

    logical :: ok
    integer :: shifted(size(old))

    associate (ranks => self%comm%size, area => product(self%width)/self%width)
      if (self%comm%is_root()) then
        shifted = old
        call shift_borders(self%n, self%periodic, area, work, ranks, shifted)
        owner = shifted
        if (longest_time(ranks, work, shifted) > tolerated*sum(work)/ranks) then
          call partition_block(self%n, self%periodic, area, work, ranks, owner, ok)
          if (.not. ok) call give_up(self%comm, 'METIS could not cut the tiles into parts')
          call relabel(ranks, sum(work, 1), old, owner)
          if (longest_time(ranks, work, owner) >= worth_it*longest_time(ranks, work, shifted)) owner = shifted
        end if
      end if
    end associate
    call self%comm%broadcast(owner)
  end function dealt_out

  !> The time that the work takes over that which it would take if it were spread evenly, from the work in each tile, as far as this
  !> rank knows; 1 if there is none. All ranks take part.
  function imbalance(self, weights)
    class(tiles_t), intent(in) :: self
    real(wp), intent(in) :: weights(:,:)  !< (kinds, total) any unit
    real(wp) :: imbalance

    real(wp) :: load(size(weights, 1), self%comm%size)

    load = loads(self%comm%size, weights, self%owner)
    load = reshape(self%comm%sum([load]), shape(load))
    imbalance = 1.0_wp
    if (any(load > 0.0_wp)) imbalance = sum(maxval(load, 2))*self%comm%size/sum(load)
  end function imbalance

  !> Place of a tile in each direction, from 0.
  pure function place_of(self, tile) result(place)
    class(tiles_t), intent(in) :: self
    integer, intent(in) :: tile
    integer :: place(3)

    place = place_in_block(self%n, tile - 1)
  end function place_of

  pure function tile_at(n, place) result(tile)
    integer, intent(in) :: n(3), place(3)
    integer :: tile

    tile = 1 + vertex_at(n, place)
  end function tile_at

  !> Lowest and highest corner of a tile [m]; walls do not count, see above.
  pure subroutine bounds(self, tile, low, high)
    class(tiles_t), intent(in) :: self
    integer, intent(in) :: tile
    real(wp), intent(out) :: low(3), high(3)

    associate (place => self%place_of(tile))
      low = self%lower + place*self%width
      high = self%lower + (place + 1)*self%width
    end associate
  end subroutine bounds

  !> The tile a position belongs to; positions beyond a periodic face are those of their image inside.
  pure function tile_of(self, x) result(tile)
    class(tiles_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    integer :: tile

    integer :: a, place(3)

    do a = 1, 3
      place(a) = floor((x(a) - self%lower(a))*self%per_metre(a))
      if (self%periodic(a)) then
        place(a) = modulo(place(a), self%n(a))
      else
        place(a) = max(0, min(place(a), self%n(a) - 1))
      end if
    end do
    tile = tile_at(self%n, place)
  end function tile_of

  !> The rank of the tile a position belongs to.
  pure function owner_of(self, x) result(rank)
    class(tiles_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    integer :: rank

    rank = self%owner(self%tile_of(x))
  end function owner_of

  !> Bring a position that has left through a periodic face back to its image inside.
  pure subroutine wrap(self, x)
    class(tiles_t), intent(in) :: self
    real(wp), intent(inout) :: x(3)  !< [m]

    integer :: a
    real(wp) :: extent

    do a = 1, 3
      if (.not. self%periodic(a)) cycle
      if (x(a) >= self%lower(a) .and. x(a) < self%upper(a)) cycle
      extent = self%upper(a) - self%lower(a)
      x(a) = x(a) - extent*floor((x(a) - self%lower(a))/extent)
      ! a position a rounding error below the lower face would land on the upper one
      if (x(a) >= self%upper(a)) x(a) = self%lower(a)
    end do
  end subroutine wrap

  !> Where a parcel of mine must be present as a ghost: every rank, with the shift of the position, that owns a
  !> tile within `range` of x + shift. No tile is thinner than the range, so these are around the parcel's own.
  subroutine images(self, x, range, rank, shift, count)
    class(tiles_t), intent(in) :: self
    real(wp), intent(in) :: x(3)             !< [m]
    real(wp), intent(in) :: range            !< [m]
    integer, intent(inout) :: rank(:)        !< (most_images)
    real(wp), intent(inout) :: shift(:,:)    !< (3, most_images) [m]
    integer, intent(out) :: count

    integer :: at(3), from(3), to(3), tile(-1:1, 3), turns(-1:1, 3), way, ways(most_images), owner, stride, a, i, j, k, m
    real(wp) :: square(-1:1, 3)

    count = 0
    at = floor((x - self%lower)*self%per_metre)
    where (.not. self%periodic) at = max(0, min(at, self%n - 1))
    if (all(at >= 0 .and. at < self%n)) then
      if (self%inner(tile_at(self%n, at))) return
    end if
    stride = 1
    do a = 1, 3
      call look_along(self, a, at(a), x(a), range, from(a), to(a), tile(:, a), turns(:, a), square(:, a))
      tile(:, a) = stride*tile(:, a)
      stride = stride*self%n(a)
    end do
    do k = from(3), to(3)
      do j = from(2), to(2)
        do i = from(1), to(1)
          owner = self%owner(1 + tile(i, 1) + tile(j, 2) + tile(k, 3))
          way = turns(i, 1) + 3*(turns(j, 2) + 3*turns(k, 3))  ! no two are alike
          if (owner == self%comm%rank .and. way == 0) cycle
          if (square(i, 1) + square(j, 2) + square(k, 3) > range**2) cycle
          do m = 1, count
            if (rank(m) == owner .and. ways(m) == way) exit
          end do
          if (m <= count) cycle
          count = m
          rank(m) = owner
          ways(m) = way
          shift(:, m) = [turns(i, 1), turns(j, 2), turns(k, 3)]*(self%upper - self%lower)
        end do
      end do
    end do
  end subroutine images

  !> The tile at place `at` and its two neighbours along direction a, of which `from` to `to` are within range.
  pure subroutine look_along(self, a, at, x, range, from, to, place, turns, square)
    class(tiles_t), intent(in) :: self
    integer, intent(in) :: a, at             !< the place may lie beyond a periodic face
    real(wp), intent(in) :: x, range         !< [m]
    integer, intent(out) :: from, to         !< -1 to 1
    integer, intent(out) :: place(-1:1)      !< within the domain
    integer, intent(out) :: turns(-1:1)      !< lengths of the domain from the tile to that place
    real(wp), intent(out) :: square(-1:1)    !< of the distance from x to the tile [m2]

    real(wp) :: below, above

    below = x - (self%lower(a) + at*self%width(a))
    above = self%lower(a) + (at + 1)*self%width(a) - x
    from = merge(-1, 0, below <= range .and. (self%periodic(a) .or. at > 0))
    to = merge(1, 0, above <= range .and. (self%periodic(a) .or. at < self%n(a) - 1))
    square = [below**2, 0.0_wp, above**2]
    place = at + [-1, 0, 1]
    turns = 0
    if (.not. self%periodic(a)) return
    place = modulo(place, self%n(a))
    turns = (place - at - [-1, 0, 1])/self%n(a)
  end subroutine look_along

end module tiles
