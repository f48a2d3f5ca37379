!> The triangles of the walls that are meshes: one rank reads them and gives them to the others.
module mesh_reading
  use case, only: case_t
  use case_keys, only: keys_t
  use communicator, only: communicator_t
  use files, only: exists
  use kinds, only: wp
  use stl_file, only: read_stl
  use surface, only: new_surface
  implicit none
  private
  public :: read_meshes

contains

  !> Fill case%surfaces where walls are meshes; add to keys%problems what is wrong with a file.
  subroutine read_meshes(case, keys, comm)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys
    type(communicator_t), intent(in), optional :: comm  !< all its ranks take part; without one every caller reads

    real(wp), allocatable :: triangles(:,:,:)
    character(len=:), allocatable :: message
    integer :: w, t

    do w = 1, size(case%walls)
      associate (wall => case%walls(w))
        if (wall%kind /= 'mesh' .or. len_trim(wall%file) == 0) cycle
        if (.not. exists(trim(wall%file))) cycle  ! known already
        call read_once(trim(wall%file), triangles, message, comm)
        call keys%require_at(len(message) == 0, 'wall', w, 'file', message)
        if (len(message) > 0) cycle
        do t = 1, size(triangles, 3)
          triangles(:, :, t) = wall%scale*triangles(:, :, t) + spread(wall%offset, 2, 3)
        end do
        case%surfaces(w) = new_surface(triangles)
        call keys%require_at(case%surfaces(w)%n > 0, 'wall', w, 'file', 'holds no triangle that has an area')
      end associate
    end do
  end subroutine read_meshes

  subroutine read_once(path, triangles, message, comm)
    character(len=*), intent(in) :: path
    real(wp), allocatable, intent(out) :: triangles(:,:,:)  !< (3,3,n)
    character(len=:), allocatable, intent(out) :: message
    type(communicator_t), intent(in), optional :: comm

    real(wp), allocatable :: flat(:)
    integer :: n(1)

    if (.not. present(comm)) then
      call read_stl(path, triangles, message)
      return
    end if
    if (comm%is_root()) call read_stl(path, triangles, message)
    call comm%broadcast(message)
    n = 0
    if (comm%is_root()) n = size(triangles, 3)
    call comm%broadcast(n)
    allocate (flat(9*n(1)))
    if (comm%is_root()) flat = reshape(triangles, [9*n(1)])
    call comm%broadcast(flat)
    triangles = reshape(flat, [3, 3, n(1)])
  end subroutine read_once

end module mesh_reading
