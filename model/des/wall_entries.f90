!> What is kept of parcels near walls: which wall it is, and what a contact with it remembers. First those near faces of the
!> chamber, then near planes, then shells, then triangles; each ordered by column, so that a step takes some parcels after others.
module wall_entries
  use chamber, only: chamber_t
  use kinds, only: wp
  implicit none
  private
  public :: wall_entries_t, shift_of

  type :: wall_entries_t
    logical :: with_history = .false.
    logical :: with_angles = .false.      !< whether contacts remember how far they have rolled
    integer :: entries = 0
    integer :: kind_end(4) = 0            !< last entry of faces, of planes, of shells, of triangles
    integer :: first(4) = 1, last(4) = 0  !< entries of faces, of planes, of shells, and runs, that were taken last
    real(wp) :: step = 0.0_wp             !< number of this step
    real(wp) :: way = 0.0_wp              !< that a parcel and a mesh may have gone since the list was made, together [m]
    integer, allocatable :: parcel(:)     !< (entries) column
    integer, allocatable :: face(:)       !< (entries) see chamber
    integer, allocatable :: image(:)      !< (entries) in a periodic chamber: which image of the parcel is near the triangle
    real(wp), allocatable :: slip(:,:)    !< (4, entries) 1:3 tangential slip [m], 4 step of last touch
    real(wp), allocatable :: angle(:,:)   !< (3, entries) with the rolling spring: angle rolled [rad]
    integer :: runs = 0                   !< triangles of one mesh near one parcel, one after the other
    integer, allocatable :: run_first(:)  !< (runs + 1 at least) first entry of each
    real(wp), allocatable :: run_gap(:)   !< (runs at least) between parcel and mesh when the list was made [m]
  contains
    procedure :: begin_step
    procedure :: take_parcels
    procedure :: begin_runs
    procedure :: end_run
    procedure :: run_range
    procedure :: memory_of
    procedure :: remind
  end type wall_entries_t

contains

  !> A step in which nothing is taken yet.
  pure subroutine begin_step(self, step, way)
    class(wall_entries_t), intent(inout) :: self
    real(wp), intent(in) :: step  !< number
    real(wp), intent(in) :: way   !< that a parcel and a mesh may have gone since the list was made, together [m]

    self%step = step
    self%way = way
    self%last = [0, self%kind_end(1:2), 0]
  end subroutine begin_step

  !> Take what there is of the parcels up to a column that were not taken yet.
  pure subroutine take_parcels(self, column)
    class(wall_entries_t), intent(inout) :: self
    integer, intent(in) :: column

    integer :: kind

    self%first = self%last + 1
    do kind = 1, 3
      do while (self%last(kind) < self%kind_end(kind))
        if (self%parcel(self%last(kind) + 1) > column) exit
        self%last(kind) = self%last(kind) + 1
      end do
    end do
    do while (self%last(4) < self%runs)
      if (self%parcel(self%run_first(self%last(4) + 1)) > column) exit
      self%last(4) = self%last(4) + 1
    end do
  end subroutine take_parcels

  !> No run yet; the first begins behind an entry.
  subroutine begin_runs(self, last)
    class(wall_entries_t), intent(inout) :: self
    integer, intent(in) :: last

    self%runs = 0
    if (.not. allocated(self%run_gap)) allocate (self%run_gap(64), self%run_first(64))
    self%run_first(1) = last + 1
  end subroutine begin_runs

  !> The entries since the last run, up to `last`, are one, if there are any.
  subroutine end_run(self, last, gap)
    class(wall_entries_t), intent(inout) :: self
    integer, intent(in) :: last
    real(wp), intent(in) :: gap  !< [m]

    if (last < self%run_first(self%runs + 1)) return
    self%runs = self%runs + 1
    if (self%runs == size(self%run_gap)) then
      self%run_gap = [self%run_gap, self%run_gap]
      self%run_first = [self%run_first, self%run_first]
    end if
    self%run_gap(self%runs) = gap
    self%run_first(self%runs + 1) = last + 1
  end subroutine end_run

  !> First and last entry of a run.
  pure function run_range(self, run) result(range)
    class(wall_entries_t), intent(in) :: self
    integer, intent(in) :: run
    integer :: range(2)

    range = [self%run_first(run), self%run_first(run + 1) - 1]
  end function run_range

  !> What an entry remembers beside the step of its last touch: the slip and the angle, 0 if there is none.
  pure function memory_of(self, entry) result(memory)
    class(wall_entries_t), intent(in) :: self
    integer, intent(in) :: entry
    real(wp) :: memory(6)

    memory = [self%slip(1:3, entry), 0.0_wp, 0.0_wp, 0.0_wp]
    if (self%with_angles) memory(4:6) = self%angle(:, entry)
  end function memory_of

  !> Give it back.
  pure subroutine remind(self, entry, memory, step)
    class(wall_entries_t), intent(inout) :: self
    integer, intent(in) :: entry
    real(wp), intent(in) :: memory(6)  !< as `memory_of`
    real(wp), intent(in) :: step       !< of the last touch

    self%slip(:, entry) = [memory(1:3), step]
    if (self%with_angles) self%angle(:, entry) = memory(4:6)
  end subroutine remind

  !> What brings a parcel to the image of it that is near the triangle of an entry [m].
  pure function shift_of(self, chamber, entry) result(shift)
    class(wall_entries_t), intent(in) :: self
    type(chamber_t), intent(in) :: chamber
    integer, intent(in) :: entry
    real(wp) :: shift(3)

    shift = 0.0_wp
    if (any(chamber%periodic)) shift = chamber%shift(self%image(entry))
  end function shift_of

end module wall_entries
