!> The file of the parcels, parcels.vtkhdf: a cloud of points with fields at every output time, as VTK's temporal
!> PolyData, which ParaView opens; parcels.xmf beside it serves ParaView before 5.12 from the same data.
!>
!>   call parcels%open(name, comm, origin, outcome, after)
!>   call parcels%begin_step(time, position)
!>   call parcels%add('velocity', velocity, 'm/s')      any number of fields, the same in every step
!>   call parcels%end_step(outcome)
!>   call parcels%close(outcome)
!>
!> Real numbers are stored in single precision. A step is one part whatever the number of ranks.
module vtkhdf_parcels
  use agreement, only: agree
  use communicator, only: communicator_t
  use hdf5_arrays, only: share_t, share_of, put_columns, get_columns, put_attribute
  use hdf5_file, only: single_kind, long_kind, integer_kind
  use kinds, only: wp, sp, i8
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use vtkhdf_steps, only: vtkhdf_t, put_row, whole
  use xdmf, only: write_cloud_sidecar
  implicit none
  private
  public :: vtkhdf_parcels_t

  character(len=*), parameter :: root = '/VTKHDF/'
  character(len=*), parameter :: vertices = root//'Vertices/', lines = root//'Lines/', of_steps = root//'Steps/'
  integer(i8), parameter :: chunk = 16384  !< parcels stored together

  type, extends(vtkhdf_t) :: vtkhdf_parcels_t
    private
    integer(i8) :: first = 0                 !< points of the steps before this one
    integer(i8), allocatable :: points(:)    !< of every step, with room for more
    integer(i8) :: longest = 0               !< points of the largest step so far
    type(share_t) :: share                   !< of the step being added
  contains
    procedure :: open => open_parcels
    procedure :: begin_step
    procedure, private :: add_scalars, add_vectors, add_longs, add_integers
    generic :: add => add_scalars, add_vectors, add_longs, add_integers
    procedure :: end_step
    procedure :: close => close_parcels
  end type vtkhdf_parcels_t

contains

  !> Begin the file, or go on with that of the run which is continued at the time `after`.
  subroutine open_parcels(self, name, comm, origin, outcome, after)
    class(vtkhdf_parcels_t), intent(out) :: self
    character(len=*), intent(in) :: name      !< ending in .vtkhdf
    type(communicator_t), intent(in) :: comm
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome
    real(wp), intent(in), optional :: after   !< [s]

    logical :: fresh

    call self%start(name, comm, after, fresh)
    if (comm%is_root()) then
      if (fresh) call make_tables(self, origin)
      if (.not. fresh) call keep_points(self)
    end if
    call self%started(outcome)
    if (.not. allocated(self%points)) allocate (self%points(size(self%times)), source=0_i8)
    if (outcome%failed()) return
    call comm%broadcast(self%points)
    self%first = sum(self%points(:self%steps))
    self%longest = maxval([0_i8, self%points(:self%steps)])
  end subroutine open_parcels

  !> What a file of points needs before its first step. A step is one part with one cell, of the kind that holds any number of
  !> points; of the three other kinds there is none.
  subroutine make_tables(self, origin)
    type(vtkhdf_parcels_t), intent(inout) :: self
    type(provenance_t), intent(in) :: origin

    call self%introduce('PolyData', [2, 0], origin)
    call self%file%make(root//'Points', single_kind, [3_i8, 0_i8], [3_i8, chunk])
    call put_attribute(self%file, root//'Points', 'unit', 'm')
    call self%file%make(vertices//'Connectivity', long_kind, [0_i8], [chunk])
    call self%make_rows(root//'NumberOfPoints', [vertices//'NumberOfConnectivityIds'])
    call self%make_rows(vertices//'Offsets')
    call self%make_rows(vertices//'NumberOfCells', [of_steps//'NumberOfParts'])
    call self%make_rows(lines//'Offsets', lines//['NumberOfCells          ', 'NumberOfConnectivityIds'])
    call self%make_rows(lines//'Connectivity')
    call self%file%give_name(root//'Lines', root//'Polygons')
    call self%file%give_name(root//'Lines', root//'Strips')
    call self%make_rows(of_steps//'PartOffsets')
    call self%make_rows(of_steps//'PointOffsets')
    call self%make_rows(of_steps//'CellOffsets', columns=4)
    call self%make_rows(of_steps//'ConnectivityIdOffsets', columns=4)
  end subroutine make_tables

  !> Of a file that is continued: how many points its steps have.
  subroutine keep_points(self)
    type(vtkhdf_parcels_t), intent(inout) :: self

    allocate (self%points(size(self%times)), source=0_i8)
    if (self%steps > 0) call get_columns(self%file, root//'NumberOfPoints', self%points(:self%steps), 0_i8)
  end subroutine keep_points

  subroutine begin_step(self, time, position)
    class(vtkhdf_parcels_t), intent(inout) :: self
    real(wp), intent(in) :: time           !< [s]
    real(wp), intent(in) :: position(:,:)  !< (3, my parcels) [m]

    call self%begin(time)
    if (self%repeated) return
    if (size(self%points) < size(self%times)) self%points = [self%points, 0*self%points]
    self%share = share_of(self%comm, size(position, 2))
    call put_columns(self%file, root//'Points', real(position, sp), self%share, self%first)
  end subroutine begin_step

  !> A number of every parcel.
  subroutine add_scalars(self, name, x, unit)
    class(vtkhdf_parcels_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    real(wp), intent(in) :: x(:)

    if (self%repeated) return
    call know(self, name, unit, 1, single_kind)
    call put_columns(self%file, root//'PointData/'//name, real(x, sp), self%share, self%first)
  end subroutine add_scalars

  !> A vector (3, my parcels) of every parcel.
  subroutine add_vectors(self, name, x, unit)
    class(vtkhdf_parcels_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    real(wp), intent(in) :: x(:,:)

    if (self%repeated) return
    call know(self, name, unit, 3, single_kind)
    call put_columns(self%file, root//'PointData/'//name, real(x, sp), self%share, self%first)
  end subroutine add_vectors

  subroutine add_longs(self, name, x, unit)
    class(vtkhdf_parcels_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    integer(i8), intent(in), contiguous :: x(:)

    if (self%repeated) return
    call know(self, name, unit, 1, long_kind)
    call put_columns(self%file, root//'PointData/'//name, x, self%share, self%first)
  end subroutine add_longs

  subroutine add_integers(self, name, x, unit)
    class(vtkhdf_parcels_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    integer, intent(in), contiguous :: x(:)

    if (self%repeated) return
    call know(self, name, unit, 1, integer_kind)
    call put_columns(self%file, root//'PointData/'//name, x, self%share, self%first)
  end subroutine add_integers

  !> Make the field unless it is there.
  subroutine know(self, name, unit, components, kind)
    type(vtkhdf_parcels_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    integer, intent(in) :: components, kind

    integer(i8) :: extent(2), pieces(2)
    integer :: from

    if (self%has_field(root//'PointData/', name, components, kind)) return
    from = merge(2, 1, components == 1)
    extent = [int(components, i8), 0_i8]
    pieces = [int(components, i8), chunk]
    call self%file%make(root//'PointData/'//name, kind, extent(from:), pieces(from:))
    call put_attribute(self%file, root//'PointData/'//name, 'unit', unit)
  end subroutine know

  !> Close the step; from now on readers see it.
  subroutine end_step(self, outcome)
    class(vtkhdf_parcels_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%repeated) return
    call self%close_bulk(outcome)
    if (outcome%failed()) return
    self%points(self%steps + 1) = self%share%total
    if (self%comm%is_root()) then
      call put_tables(self)
      call self%show_step(of_steps//'PointOffsets', of_steps//'PointDataOffsets/', outcome)
      call put_sidecar(self, self%steps + 1, .false., outcome)
    end if
    self%first = self%first + self%share%total
    call self%finish(outcome)
  end subroutine end_step

  !> The entries of this step.
  subroutine put_tables(self)
    type(vtkhdf_parcels_t), intent(inout) :: self

    integer(i8) :: n, i

    n = self%share%total
    associate (file => self%file, row => self%steps)
      ! The points of every cell are 0, 1, 2, ..., so all steps share one list, as long as the largest needs.
      if (n > self%longest) then
        call put_columns(file, vertices//'Connectivity', [(i, i=self%longest, n - 1)], whole(int(n - self%longest)), self%longest)
        self%longest = n
      end if
      call put_row(file, root//'NumberOfPoints', row, [n])
      call put_row(file, vertices//'Offsets', row, [0_i8, n])
      call put_row(file, vertices//'NumberOfCells', row, [1_i8])
      call put_row(file, lines//'Offsets', row, [0_i8])
      call put_row(file, of_steps//'PartOffsets', row, [int(row, i8)])
      call put_row(file, of_steps//'PointOffsets', row, [self%first])
      call put_row(file, of_steps//'CellOffsets', row, reshape([int(row, i8), 0_i8, 0_i8, 0_i8], [4, 1]))
      call put_row(file, of_steps//'ConnectivityIdOffsets', row, reshape([0_i8, 0_i8, 0_i8, 0_i8], [4, 1]))
    end associate
  end subroutine put_tables

  subroutine put_sidecar(self, steps, at_end, outcome)
    type(vtkhdf_parcels_t), intent(inout) :: self
    integer, intent(in) :: steps  !< in the file
    logical, intent(in) :: at_end
    type(outcome_t), intent(inout) :: outcome

    if (.not. self%sidecar_is_due(steps, at_end)) return
    call write_cloud_sidecar(self%name, self%fields, self%times(:steps), self%points(:steps), outcome)
  end subroutine put_sidecar

  !> Complete the sidecar.
  subroutine close_parcels(self, outcome)
    class(vtkhdf_parcels_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call put_sidecar(self, self%steps, .true., outcome)
    call agree(self%comm, outcome)
  end subroutine close_parcels

end module vtkhdf_parcels
