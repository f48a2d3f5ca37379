!> The parcels of this rank, in columns 1 to n, and copies of its neighbours' parcels (ghosts) behind.
!>
!> What a contact reads lies in one row of `state`, so that a pair costs two short runs of memory.
module parcels
  use cache_lines, only: line_start, line_reals
  use constants, only: pi
  use kinds, only: wp, i8
  implicit none
  private
  public :: parcels_t, position_row, radius_row, velocity_row, mass_row, spin_row, curvature_row, &
    drive_row, drag_row, before_row, frictional_rows, frictionless_rows, coupled_rows, force_place

  ! Rows of `state`.
  integer, parameter :: position_row = 1  !< 1:3 position [m]
  integer, parameter :: radius_row = 4    !< collision radius [m]
  integer, parameter :: velocity_row = 5  !< 5:7 velocity [m/s]
  integer, parameter :: mass_row = 8      !< inverse of the parcel's mass [1/kg]
  integer, parameter :: spin_row = 9      !< 9:11 angular velocity times collision radius [m/s]
  integer, parameter :: curvature_row = 12  !< inverse of the collision radius [1/m]
  integer, parameter :: frictional_rows = 12, frictionless_rows = 8

  ! Rows of `coupled`.
  integer, parameter :: drive_row = 1     !< 1:3 acceleration by all but contacts, over a gas step [m/s2]
  integer, parameter :: drag_row = 4      !< 4:6 acceleration by drag in the last gas step [m/s2]
  integer, parameter :: before_row = 7    !< 7:9 velocity at the start of the last gas step [m/s]
  integer, parameter :: coupled_rows = 12

  integer, parameter :: own_rows = 5      !< of a message, besides state, aside and coupled: diameter, weight, built

  type :: parcels_t
    integer :: n = 0                          !< my own
    integer :: n_ghost = 0                    !< copies of others' parcels, in columns n+1 on
    integer :: capacity = 0                   !< columns of all arrays
    logical :: rotation = .false.             !< whether parcels spin: state has 12 rows, else 8
    logical :: with_gas = .false.             !< whether `coupled` exists
    real(wp), allocatable :: state(:,:)       !< (12 or 8, capacity), see the rows above
    real(wp), allocatable :: force(:)         !< columns 0 to `ring`, of 8 or 4, of contact force 1:3 [N], torque/radius 5:7 [N],
                                              !< from element `force_start` on: see force_place, force_at
    integer :: force_start = 1                !< begins a cache line
    integer :: ring = 0                       !< a power of two
    real(wp), allocatable :: coupled(:,:)     !< (12, capacity) what the gas does, see the rows above
    real(wp), allocatable :: aside(:,:)       !< (8 or 4, capacity) rows of `state` from velocity on, or their lead: see motion
    real(wp), allocatable :: built(:,:)       !< (3, capacity) position when the neighbour list was made [m]
    real(wp), allocatable :: diameter(:)      !< of one real particle [m]
    real(wp), allocatable :: weight(:)        !< real particles per parcel [-]
    integer, allocatable :: powder(:)
    integer(i8), allocatable :: id(:)         !< own and ghosts
  contains
    procedure :: create
    procedure :: reserve
    procedure :: append
    procedure :: make_ring
    procedure :: force_at
    procedure :: move
    procedure :: reorder
    procedure :: n_all
    procedure :: packed_rows
    procedure :: pack_rows
    procedure :: unpack_rows
  end type parcels_t

contains

  subroutine create(self, rotation, with_gas)
    class(parcels_t), intent(out) :: self
    logical, intent(in) :: rotation, with_gas

    self%rotation = rotation
    self%with_gas = with_gas
    call self%reserve(64)
  end subroutine create

  !> Own parcels and ghosts.
  pure function n_all(self)
    class(parcels_t), intent(in) :: self
    integer :: n_all

    n_all = self%n + self%n_ghost
  end function n_all

  !> Room for at least `columns` parcels; what is there stays.
  subroutine reserve(self, columns)
    class(parcels_t), intent(inout) :: self
    integer, intent(in) :: columns

    integer :: capacity

    if (columns <= self%capacity) return
    capacity = columns + columns/4
    call grow(self%state, merge(frictional_rows, frictionless_rows, self%rotation), capacity)
    if (self%with_gas) call grow(self%coupled, coupled_rows, capacity)
    call grow(self%aside, size(self%state, 1) - radius_row, capacity)
    call grow(self%built, 3, capacity)
    call grow_reals(self%diameter, capacity)
    call grow_reals(self%weight, capacity)
    call grow_integers(self%powder, capacity)
    call grow_longs(self%id, capacity)
    self%capacity = capacity
  end subroutine reserve

  !> New parcels behind my own. Ghosts are not kept.
  subroutine append(self, position, velocity, diameter, weight, density, powder, id)
    class(parcels_t), intent(inout) :: self
    real(wp), intent(in) :: position(:,:)     !< (3,m) [m]
    real(wp), intent(in) :: velocity(:,:)     !< (3,m) [m/s]
    real(wp), intent(in) :: diameter(:)       !< (m) of one real particle [m]
    real(wp), intent(in) :: weight(:)         !< (m) real particles in a parcel [-]
    real(wp), intent(in) :: density(:)        !< (m) of the solid [kg/m3]
    integer, intent(in) :: powder(:)          !< (m)
    integer(i8), intent(in) :: id(:)          !< (m)

    integer :: m, c

    call self%reserve(self%n + size(id))
    self%n_ghost = 0
    do m = 1, size(id)
      c = self%n + m
      self%state(:, c) = 0.0_wp
      self%state(1:3, c) = position(:, m)
      self%state(radius_row, c) = 0.5_wp*diameter(m)*weight(m)**(1.0_wp/3.0_wp)
      self%state(5:7, c) = velocity(:, m)
      self%state(mass_row, c) = 1/(weight(m)*density(m)*pi/6*diameter(m)**3)
      if (self%rotation) self%state(curvature_row, c) = 1/self%state(radius_row, c)
      self%aside(:, c) = 0.0_wp
      self%diameter(c) = diameter(m)
      self%weight(c) = weight(m)
      self%powder(c) = powder(m)
      self%id(c) = id(m)
      if (self%with_gas) self%coupled(:, c) = 0.0_wp
    end do
    self%n = self%n + size(id)
  end subroutine append

  !> Room for the forces on so many parcels at a time. None is in use.
  subroutine make_ring(self, window)
    class(parcels_t), intent(inout) :: self
    integer, intent(in) :: window

    if (self%ring >= min(window, self%n) .and. self%ring > 0) return
    self%ring = max(self%ring, 1)
    do while (self%ring < min(window, self%n))
      self%ring = 2*self%ring
    end do
    if (allocated(self%force)) deallocate (self%force)
    allocate (self%force(force_rows(self)*(self%ring + 1) + line_reals - 1), source=0.0_wp)
    self%force_start = line_start(self%force)
  end subroutine make_ring

  !> The column of `force` for a parcel. A parcel's force is gathered from the stretch of rows that has its first partner to
  !> that of its own, where it moves and the force is spent. So parcels take turns in few columns, which stay in the cache. Nobody
  !> asks for the force on a ghost: it goes to column 0.
  elemental function force_place(column, own, ring) result(place)
    integer, intent(in) :: column  !< of the parcel
    integer, intent(in) :: own     !< parcels of this rank
    integer, intent(in) :: ring    !< a power of two
    integer :: place

    place = merge(1 + iand(column - 1, ring - 1), 0, column <= own)
  end function force_place

  !> The first element of `force` for a parcel.
  pure function force_at(self, column) result(at)
    class(parcels_t), intent(in) :: self
    integer, intent(in) :: column
    integer :: at

    at = self%force_start + force_rows(self)*force_place(column, self%n, self%ring)
  end function force_at

  pure function force_rows(self) result(rows)
    class(parcels_t), intent(in) :: self
    integer :: rows

    rows = merge(frictional_rows, frictionless_rows, self%rotation) - radius_row
  end function force_rows

  !> Put parcel i into column place(i), which is not above i, and forget it where that is not positive. Ghosts are not kept.
  pure subroutine move(self, place)
    class(parcels_t), intent(inout) :: self
    integer, intent(in) :: place(:)  !< (n)

    integer :: i, k

    do i = 1, size(place)
      k = place(i)
      if (k <= 0 .or. k == i) cycle
      self%state(:, k) = self%state(:, i)
      self%aside(:, k) = self%aside(:, i)
      self%built(:, k) = self%built(:, i)
      if (self%with_gas) self%coupled(:, k) = self%coupled(:, i)
      self%diameter(k) = self%diameter(i)
      self%weight(k) = self%weight(i)
      self%powder(k) = self%powder(i)
      self%id(k) = self%id(i)
    end do
    self%n = count(place > 0)
    self%n_ghost = 0
  end subroutine move

  !> Put parcel order(k) into column k, for k from 1 to size(order), which becomes the number of
  !> parcels. Ghosts are not kept.
  subroutine reorder(self, order)
    class(parcels_t), intent(inout) :: self
    integer, intent(in) :: order(:)

    integer :: n

    n = size(order)
    call reorder_rows(size(self%state, 1), order, self%state)
    call reorder_rows(size(self%aside, 1), order, self%aside)
    call reorder_rows(3, order, self%built)
    if (self%with_gas) call reorder_rows(coupled_rows, order, self%coupled)
    self%diameter(1:n) = self%diameter(order)
    self%weight(1:n) = self%weight(order)
    self%powder(1:n) = self%powder(order)
    self%id(1:n) = self%id(order)
    self%n = n
    self%n_ghost = 0
  end subroutine reorder

  subroutine reorder_rows(rows, order, array)
    integer, intent(in) :: rows, order(:)
    real(wp), allocatable, intent(inout) :: array(:,:)  !< (rows, capacity)

    real(wp), allocatable :: reordered(:,:)
    integer :: k

    allocate (reordered(rows, size(array, 2)))
    do k = 1, size(order)
      reordered(1:rows, k) = array(1:rows, order(k))
    end do
    call move_alloc(reordered, array)
  end subroutine reorder_rows

  !> Rows of reals that carry one parcel from rank to rank.
  pure function packed_rows(self)
    class(parcels_t), intent(in) :: self
    integer :: packed_rows

    packed_rows = size(self%state, 1) + own_rows + size(self%aside, 1)
    if (self%with_gas) packed_rows = packed_rows + coupled_rows
  end function packed_rows

  !> Write the parcels in the given columns into rows for a message.
  subroutine pack_rows(self, columns, reals, longs)
    class(parcels_t), intent(in) :: self
    integer, intent(in) :: columns(:)
    real(wp), intent(out) :: reals(:,:)      !< (packed_rows, size(columns))
    integer(i8), intent(out) :: longs(:,:)   !< (2, size(columns)): id, powder

    integer :: k, c, rows, last

    rows = size(self%state, 1)
    last = rows + own_rows + size(self%aside, 1)
    do k = 1, size(columns)
      c = columns(k)
      reals(1:rows, k) = self%state(:, c)
      reals(rows + 1, k) = self%diameter(c)
      reals(rows + 2, k) = self%weight(c)
      reals(rows + 3:rows + own_rows, k) = self%built(:, c)
      reals(rows + own_rows + 1:last, k) = self%aside(:, c)
      if (self%with_gas) reals(last + 1:, k) = self%coupled(:, c)
      longs(:, k) = [self%id(c), int(self%powder(c), i8)]
    end do
  end subroutine pack_rows

  !> Append the parcels of a message.
  subroutine unpack_rows(self, reals, longs)
    class(parcels_t), intent(inout) :: self
    real(wp), intent(in) :: reals(:,:)
    integer(i8), intent(in) :: longs(:,:)

    integer :: k, c, rows, last

    call self%reserve(self%n + size(reals, 2))
    rows = size(self%state, 1)
    last = rows + own_rows + size(self%aside, 1)
    do k = 1, size(reals, 2)
      c = self%n + k
      self%state(:, c) = reals(1:rows, k)
      self%diameter(c) = reals(rows + 1, k)
      self%weight(c) = reals(rows + 2, k)
      self%built(:, c) = reals(rows + 3:rows + own_rows, k)
      self%aside(:, c) = reals(rows + own_rows + 1:last, k)
      if (self%with_gas) self%coupled(:, c) = reals(last + 1:, k)
      self%id(c) = longs(1, k)
      self%powder(c) = int(longs(2, k))
    end do
    self%n = self%n + size(reals, 2)
    self%n_ghost = 0
  end subroutine unpack_rows

  subroutine grow(array, rows, capacity)
    real(wp), allocatable, intent(inout) :: array(:,:)
    integer, intent(in) :: rows, capacity

    real(wp), allocatable :: larger(:,:)

    allocate (larger(rows, capacity))
    larger = 0.0_wp
    if (allocated(array)) larger(:, 1:size(array, 2)) = array
    call move_alloc(larger, array)
  end subroutine grow

  subroutine grow_reals(array, capacity)
    real(wp), allocatable, intent(inout) :: array(:)
    integer, intent(in) :: capacity

    real(wp), allocatable :: larger(:)

    allocate (larger(capacity))
    larger = 0.0_wp
    if (allocated(array)) larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow_reals

  subroutine grow_integers(array, capacity)
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: capacity

    integer, allocatable :: larger(:)

    allocate (larger(capacity))
    larger = 0
    if (allocated(array)) larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow_integers

  subroutine grow_longs(array, capacity)
    integer(i8), allocatable, intent(inout) :: array(:)
    integer, intent(in) :: capacity

    integer(i8), allocatable :: larger(:)

    allocate (larger(capacity))
    larger = 0_i8
    if (allocated(array)) larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow_longs

end module parcels
