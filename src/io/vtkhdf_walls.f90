!> The file of the walls that are meshes, walls.vtkhdf: their triangles at every output time, as VTK's temporal PolyData.
!>
!>   call walls%open(name, comm, origin, outcome, after)
!>   call walls%write_step(time, corners, number, outcome)
!>
!> The root writes it. Triangles share no corners; which ones there are is written once, where they are in every step.
module vtkhdf_walls
  use communicator, only: communicator_t
  use hdf5_arrays, only: put_columns, put_attribute
  use hdf5_file, only: single_kind, long_kind, integer_kind
  use kinds, only: wp, sp, i8
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use vtkhdf_steps, only: vtkhdf_t, put_row, whole
  implicit none
  private
  public :: vtkhdf_walls_t

  character(len=*), parameter :: root = '/VTKHDF/', of_steps = root//'Steps/'
  character(len=8), parameter :: topology(4) = ['Vertices', 'Lines   ', 'Polygons', 'Strips  ']
  integer, parameter :: polygons = 3
  integer(i8), parameter :: chunk = 16384  !< points or cells stored together

  type, extends(vtkhdf_t) :: vtkhdf_walls_t
  contains
    procedure :: open => open_walls
    procedure :: write_step
  end type vtkhdf_walls_t

contains

  !> Begin the file, or go on with that of the run which is continued at the time `after`.
  subroutine open_walls(self, name, comm, origin, outcome, after)
    class(vtkhdf_walls_t), intent(out) :: self
    character(len=*), intent(in) :: name      !< ending in .vtkhdf
    type(communicator_t), intent(in) :: comm
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome
    real(wp), intent(in), optional :: after   !< [s]

    logical :: fresh

    call self%start(name, comm, after, fresh)
    if (comm%is_root() .and. fresh) then
      call self%introduce('PolyData', [2, 0], origin)
      call self%file%make(root//'Points', single_kind, [3_i8, 0_i8], [3_i8, chunk])
      call put_attribute(self%file, root//'Points', 'unit', 'm')
      call self%make_rows(of_steps//'PartOffsets')
      call self%make_rows(of_steps//'NumberOfParts')
      call self%make_rows(of_steps//'PointOffsets')
      call self%make_rows(of_steps//'CellOffsets', [of_steps//'ConnectivityIdOffsets'], columns=4)
    end if
    call self%started(outcome)
  end subroutine open_walls

  !> Add the triangles as they are at a time. All ranks take part.
  subroutine write_step(self, time, corners, number, outcome)
    class(vtkhdf_walls_t), intent(inout) :: self
    real(wp), intent(in) :: time            !< [s]
    real(wp), intent(in) :: corners(:,:,:)  !< (3,3,n) [m]
    integer, intent(in) :: number(:)        !< (n) of the wall each triangle belongs to
    type(outcome_t), intent(inout) :: outcome

    logical :: known
    integer(i8) :: points

    call self%begin(time)
    if (self%repeated) return
    known = self%has_field(root//'CellData/', 'wall', 1, integer_kind)
    call self%close_bulk(outcome)
    if (outcome%failed()) return
    points = 3*size(number, kind=i8)
    if (self%comm%is_root()) then
      if (.not. known) call put_topology(self, number)
      call put_columns(self%file, root//'Points', reshape(real(corners, sp), [3, 3*size(number)]), whole(3*size(number)), &
                       self%steps*points)
      associate (file => self%file, row => self%steps)
        call put_row(file, of_steps//'PartOffsets', row, [0_i8])
        call put_row(file, of_steps//'NumberOfParts', row, [1_i8])
        call put_row(file, of_steps//'PointOffsets', row, [row*points])
        call put_row(file, of_steps//'CellOffsets', row, reshape([0_i8, 0_i8, 0_i8, 0_i8], [4, 1]))
      end associate
      call self%show_step(of_steps//'PartOffsets', of_steps//'CellDataOffsets/', outcome)
    end if
    call self%finish(outcome)
  end subroutine write_step

  !> Which triangles there are: one part, the same in all steps.
  subroutine put_topology(self, number)
    type(vtkhdf_walls_t), intent(inout) :: self
    integer, intent(in) :: number(:)

    integer(i8) :: cells, i
    integer :: k

    call put_longs(self, root//'NumberOfPoints', [3*size(number, kind=i8)])
    do k = 1, size(topology)
      cells = merge(size(number), 0, k == polygons)
      call put_longs(self, root//trim(topology(k))//'/NumberOfCells', [cells])
      call put_longs(self, root//trim(topology(k))//'/NumberOfConnectivityIds', [3*cells])
      call put_longs(self, root//trim(topology(k))//'/Offsets', [(3*i, i=0, cells)])
      call put_longs(self, root//trim(topology(k))//'/Connectivity', [(i, i=0, 3*cells - 1)])
    end do
    call self%file%make(root//'CellData/wall', integer_kind, [0_i8], [chunk])
    call put_columns(self%file, root//'CellData/wall', number, whole(size(number)), 0_i8)
    call put_attribute(self%file, root//'CellData/wall', 'unit', '1')
  end subroutine put_topology

  subroutine put_longs(self, path, values)
    type(vtkhdf_walls_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(i8), intent(in) :: values(:)

    call self%file%make(path, long_kind, [0_i8], [chunk])
    if (size(values) > 0) call put_columns(self%file, path, values, whole(size(values)), 0_i8)
  end subroutine put_longs

end module vtkhdf_walls
